// Wavefront OBJ: v, f, o and g lines; texture, normal and material lines are passed over.
#include "io/format_elements.h"
#include "io/format_printer.h"

#include <fmt/format.h>

#include <unordered_map>

namespace selvage::format {

namespace {

/// Vertex of a face corner "v", "v/vt", "v//vn" or "v/vt/vn", counted from 0; faces may come before their vertices.
std::int64_t corner_vertex(const Cursor& cursor, std::string_view corner, std::int64_t vertex_count) {
  std::int64_t number = 0;
  const char* end = corner.data() + corner.size();
  const auto [stop, status] = std::from_chars(corner.data(), end, number);
  if (status != std::errc() || (stop != end && *stop != '/')) {
    cursor.fail(fmt::format("expected a vertex number, found {}", quote(corner)),
                "a face lists v, v/vt, v//vn or v/vt/vn");
  }
  if (number > std::numeric_limits<Index>::max() || number == 0 || number < -vertex_count) {
    cursor.fail(fmt::format("a face uses vertex {}, but {} vertices come before it", number, vertex_count),
                "vertices are counted from 1, or backwards from -1");
  }
  return number > 0 ? number - 1 : vertex_count + number;
}

/// The rest of the line, blanks taken as one.
std::string read_name(Cursor& cursor) {
  std::string name;
  for (std::string_view word = cursor.token(); !word.empty(); word = cursor.token()) {
    if (!name.empty()) name += ' ';
    name += word;
  }
  return name;
}

/// Gives triangles the number of the object and group that they stand in.
class GroupCollector {
 public:
  explicit GroupCollector(IndexedMesh& mesh) : mesh_(mesh) {}

  /// An `o` line, which ends the group before it, too.
  void begin_object(std::string name) {
    object_ = std::move(name);
    begin_group("");
  }
  /// A `g` line.
  void begin_group(const std::string& name) {
    number_triangles();
    const std::string whole = object_.empty() || name.empty() ? object_ + name : object_ + '/' + name;
    const auto [place, is_new] = numbers_.try_emplace(whole, static_cast<Index>(mesh_.group_names.size()));
    if (is_new) mesh_.group_names.push_back(whole);
    group_ = place->second;
  }
  /// Those that were read since the last call.
  void number_triangles() { mesh_.groups.resize(mesh_.triangles.size(), group_); }
  void finish() {
    number_triangles();
    if (mesh_.group_names.empty()) mesh_.groups.clear();
  }

 private:
  IndexedMesh& mesh_;
  std::string object_;
  Index group_ = kNone;
  std::unordered_map<std::string, Index> numbers_;
};

/// A name that stands in one word, which is what programs agree on.
std::string one_word(const std::string& name) {
  std::string word = name.empty() ? "unnamed" : name;
  for (char& c : word)
    if (static_cast<unsigned char>(c) <= ' ' || c == '#' || c == '\\' || c == 127) c = '_';
  return word;
}

}  // namespace

IndexedMesh parse_obj(const Source& source) {
  Cursor cursor(source, '#');
  cursor.bind_to_lines(true);
  cursor.join_lines_at_backslash();
  IndexedMesh mesh;
  const VertexNumbers unused;
  ElementCollector collector(cursor, mesh, unused);
  GroupCollector groups(mesh);
  std::vector<Index> polygon;
  std::int64_t largest = -1;
  std::size_t largest_position = 0;
  for (; cursor.next_filled_line(); cursor.next_line()) {
    const std::string_view keyword = cursor.token();
    if (keyword == "v") {
      mesh.positions.push_back(cursor.point());
    } else if (keyword == "f") {
      polygon.clear();
      for (std::string_view corner = cursor.token(); !corner.empty(); corner = cursor.token()) {
        const std::int64_t vertex = corner_vertex(cursor, corner, std::ssize(mesh.positions));
        if (vertex > largest) {
          largest = vertex;
          largest_position = cursor.last_position();
        }
        polygon.push_back(static_cast<Index>(vertex));
      }
      collector.add_polygon(polygon);
    } else if (keyword == "o") {
      groups.begin_object(read_name(cursor));
    } else if (keyword == "g") {
      groups.begin_group(read_name(cursor));
    }
  }
  groups.finish();
  if (largest >= std::ssize(mesh.positions)) {
    cursor.move_to(largest_position);
    cursor.fail(fmt::format("a face uses vertex {}, but the file has {} vertices", largest + 1, mesh.positions.size()),
                "mend the face or add the vertex");
  }
  return mesh;
}

std::string print_obj(const IndexedMesh& mesh) {
  Printer out;
  for (const Vec3& p : mesh.positions) out.text("v ").numbers(p).text("\n");
  Index group = kNone;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!mesh.groups.empty() && mesh.groups[t] != group) {
      group = mesh.groups[t];
      out.text("o ").text(group == kNone ? "unnamed" : one_word(mesh.group_names[group])).text("\n");
    }
    out.text("f ").element(mesh.triangles[t], 1).text("\n");
  }
  return out.take();
}

}  // namespace selvage::format
