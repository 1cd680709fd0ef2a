#include "bindings.h"
#include "selvage/io/point_cache.h"
#include "selvage/simulation/collider.h"

#include <cmath>
#include <fstream>

namespace selvage::python {

namespace {

/// Positions of the same vertices in each of a sequence of arrays.
std::vector<std::vector<Vec3>> frames_of(nb::handle positions) {
  if (PySequence_Check(positions.ptr()) == 0)
    throw Error("positions", std::string("a ") + Py_TYPE(positions.ptr())->tp_name + " was given",
                "give (k, n, 3) numbers: of each key frame the positions of all vertices");
  std::vector<std::vector<Vec3>> frames;
  for (const nb::handle frame : nb::borrow(positions)) {
    frames.push_back(Rows<Vec3>(frame, "positions").copy());
    if (frames.back().size() != frames.front().size())
      throw Error("positions",
                  "key frame " + std::to_string(frames.size() - 1) + " has " + std::to_string(frames.back().size()) +
                      " vertices, the first " + std::to_string(frames.front().size()),
                  "give every frame the vertices of the first");
  }
  if (frames.empty()) throw Error("positions", "there is no key frame", "give at least one");
  return frames;
}

KeyframedShape make_shape(nb::handle f, nb::handle times, nb::handle positions) {
  KeyframedShape shape{Rows<VertexTuple<3>>(f, "F").copy(), Rows<double>(times, "times").copy(), frames_of(positions)};
  if (shape.times.size() != shape.positions.size())
    throw Error("times",
                std::to_string(shape.times.size()) + " for " + std::to_string(shape.positions.size()) + " key frames",
                "give one for each");
  for (std::size_t k = 0; k < shape.times.size(); ++k)
    if (!std::isfinite(shape.times[k]) || (k > 0 && !(shape.times[k - 1] < shape.times[k])))
      throw Error("times", "that of key frame " + std::to_string(k) + " is not later than the one before",
                  "let times ascend");
  return shape;
}

/// (k, n, 3)
nb::object array_of_frames(const std::vector<std::vector<Vec3>>& frames) {
  const std::size_t vertices = frames.front().size();
  Column<double> all(frames.size() * vertices, 3);
  for (std::size_t k = 0; k < frames.size(); ++k)
    if (vertices > 0) std::memcpy(all.row(k * vertices), frames[k].data(), vertices * sizeof(Vec3));
  return std::move(all).array().attr("reshape")(frames.size(), vertices, 3);
}

PlacedTriangleMesh surface_at(const KeyframedShape& shape, double time) {
  if (!std::isfinite(time)) throw Error("time", "is not finite", "give seconds");
  const MeshShape there = shape.at(time);
  return {TriangleMesh(static_cast<Index>(there.positions.size()), there.triangles),
          Rows<Vec3>(array_of(there.positions), "positions")};
}

void write_cache(const std::filesystem::path& path, const PointCache& cache) {
  const std::string bytes = print_point_cache(cache);
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw SystemError(path.string(), "cannot be written", "name a file in a folder that can be written to");
}

}  // namespace

void bind_keyframes(nb::module_& m) {
  nb::class_<KeyframedShape>(m, "KeyframedShape", R"(A collider that changes its form by key frames, as a dancer does.

In the dict of a scene it stands for `keyframed`: see `read_scene`. The solver takes its positions in single precision,
which is what a point cache holds.

Parameters
----------
F : (m, 3) array of int
    Triangles of a closed surface, outward, that share their vertices.
times : (k,) array
    Of the key frames [s], ascending.
positions : (k, n, 3) array
    Of all vertices in each key frame [m].

Raises
------
selvage.Error
    When sizes differ, or times do not ascend. What is no solid is refused when a scene is read.

Examples
--------
A ball that grows to twice its size within a second, under a cloth:

>>> ball = selvage.make("ball", radius=0.1, cell=0.05)
>>> V, F = ball.V, ball.boundary_faces
>>> growing = selvage.KeyframedShape(F, [0, 1], [V, 2 * V])
>>> float(growing.at(0.5).V[:, 0].max().round(3)), float(growing.at(7).V[:, 0].max().round(3))
(0.15, 0.2)
>>> cloth = {"mesh": {"shape": "cloth", "size": [1, 1, 0], "cell": 0.1}, "translate": [-0.5, -0.5, 0.21],
...          "material": {"kind": "cloth", "density": 0.2}}
>>> scene = {"selvage_scene": 1, "bodies": [cloth], "colliders": [{"keyframed": growing}]}
>>> selvage.read_scene(scene)
<selvage.Scene 'scene': 1 bodies, 0 elements, 200 triangles of cloth>
)")
      .def(
          "__init__",
          [](KeyframedShape* self, nb::object f, nb::object times, nb::object positions) {
            new (self) KeyframedShape(make_shape(f, times, positions));
          },
          nb::arg("F").none(), nb::arg("times").none(), nb::arg("positions").none(),
          nb::sig("def __init__(self, F: ArrayLike, times: ArrayLike, positions: ArrayLike) -> None"))
      .def_prop_ro(
          "F", [](const KeyframedShape& s) { return array_of(s.triangles); }, nb::sig("def F(self) -> Ints"),
          "(m, 3) int32: triangles, outward.")
      .def_prop_ro(
          "times", [](const KeyframedShape& s) { return array_of(s.times); }, nb::sig("def times(self) -> Floats"),
          "(k,) float64: times of the key frames [s].")
      .def_prop_ro(
          "positions", [](const KeyframedShape& s) { return array_of_frames(s.positions); },
          nb::sig("def positions(self) -> Floats"), "(k, n, 3) float64: positions in each key frame [m].")
      .def("at", &surface_at, nb::arg("time"), nb::sig("def at(self, time: float) -> TriangleMesh"),
           R"(The surface at a time: linear between key frames, at rest before the first and after the last.

Parameters
----------
time : float
    [s]

Returns
-------
TriangleMesh

Raises
------
selvage.Error
    When a triangle names no vertex.
)")
      .def("__repr__", [](const KeyframedShape& s) {
        return "<selvage.KeyframedShape: " + std::to_string(s.positions.front().size()) + " vertices in " +
               std::to_string(s.times.size()) + " key frames>";
      });
  m.def(
      "read_point_cache",
      [](const std::filesystem::path& path) {
        const PointCache cache = without_interpreter([&] { return read_point_cache(path); });
        return nb::make_tuple(array_of_frames(cache.samples), cache.first_frame, cache.frames_per_sample);
      },
      nb::arg("path"), nb::sig("def read_point_cache(path: str | os.PathLike[str]) -> tuple[Floats, float, float]"),
      R"(Reads a .pc2: the positions of the same vertices sample by sample, as Blender and `Run.export` write them.

Parameters
----------
path : path

Returns
-------
positions : (k, n, 3) float64
first_frame : float
    Number of the frame of the first sample.
frames_per_sample : float
    From one sample to the next.

Raises
------
selvage.Error
    When the file cannot be read, or is no point cache.
)");
  m.def(
      "write_point_cache",
      [](const std::filesystem::path& path, nb::object positions, double first_frame, double frames_per_sample) {
        const PointCache cache{first_frame, frames_per_sample, frames_of(positions)};
        without_interpreter([&] { write_cache(path, cache); });
      },
      nb::arg("path"), nb::arg("positions").none(), nb::kw_only(), nb::arg("first_frame") = 0,
      nb::arg("frames_per_sample") = 1,
      nb::sig("def write_point_cache(path: str | os.PathLike[str], positions: ArrayLike, *, first_frame: float = 0, "
              "frames_per_sample: float = 1) -> None"),
      R"(Writes a .pc2, which holds single precision. Parameters as `read_point_cache` returns them.

Raises
------
selvage.Error
    When key frames differ in size.
selvage.SystemError
    When the file cannot be written.

Examples
--------
>>> import os, tempfile
>>> V = selvage.make("ball").V
>>> file = os.path.join(tempfile.mkdtemp(), "growing.pc2")
>>> selvage.write_point_cache(file, [V, 2 * V])
>>> positions, first, step = selvage.read_point_cache(file)
>>> positions.shape == (2, len(V), 3), first, step
(True, 0.0, 1.0)
)");
}

}  // namespace selvage::python
