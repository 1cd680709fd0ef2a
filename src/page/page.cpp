#include "page/page.h"

#include "core/json.h"
#include "page/encoding.h"
#include "page/page_template.h"
#include "selvage/version.h"

#include <fmt/format.h>

namespace selvage {

namespace {

constexpr std::string_view kPlaceOfData = "<!--data-->", kPlaceOfTitle = "<title>selvage</title>";

std::string escape_html(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '<') {
      escaped += "&lt;";
    } else if (c == '&') {
      escaped += "&amp;";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

/// JSON that may stand in a script element: no text in it can end the element.
std::string print_json(const Json& json) {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

}  // namespace

Page::Page(std::string_view kind, std::string_view title)
    : head_{{"schema", 1},          {"kind", kind},           {"title", title},
            {"version", version()}, {"facts", Json::array()}, {"warnings", Json::array()}} {}

void Page::add_fact(std::string_view group, std::string_view name, std::string_view value) {
  head_["facts"].push_back({group, name, value});
}

void Page::add_warning(std::string_view warning) {
  head_["warnings"].push_back(warning);
}

void Page::add_block(std::string_view name, std::string_view bytes) {
  add_deflated(name, deflate_bytes(bytes));
}

void Page::add_deflated(std::string_view name, std::string_view deflated) {
  blocks_ += fmt::format("<script type=\"text/plain\" id=\"block-{}\">", name);
  blocks_ += print_base64(deflated);
  blocks_ += "</script>\n";
}

std::string Page::print() const {
  std::string page(page_template());
  const std::string head =
      fmt::format("<script type=\"application/json\" id=\"head\">{}</script>\n", print_json(head_));
  page.replace(page.find(kPlaceOfData), kPlaceOfData.size(), head + blocks_);
  const std::string title = head_["title"].get<std::string>();
  // As JSON has it: what is no UTF-8 is replaced.
  const std::string text = Json::parse(Json(title).dump(-1, ' ', false, Json::error_handler_t::replace));
  page.replace(page.find(kPlaceOfTitle), kPlaceOfTitle.size(),
               fmt::format("<title>{} - selvage</title>", escape_html(text)));
  return page;
}

}  // namespace selvage
