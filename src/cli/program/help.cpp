#include "cli/program/help.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage::cli {

namespace {

constexpr int kNameColumn = 26;

/// The name of a value: CLI11 adds what a value is checked for behind a colon.
std::string value_name(const CLI::Option& option) {
  const std::string name = option.get_type_name();
  return name.substr(0, name.find(':'));
}

std::string name_of(const CLI::Option& option, bool is_positional) {
  if (is_positional) return value_name(option);
  std::string name = option.get_name(false, true);
  const std::size_t comma = name.find(',');
  if (comma != std::string::npos) name.insert(comma + 1, " ");
  return option.get_type_size() == 0 ? name : name + " " + value_name(option);
}

/// An option as it is typed, the short name if it has one.
std::string usage_of(const CLI::Option& option) {
  const std::string name = option.get_snames().empty() ? "--" + option.get_lnames()[0] : "-" + option.get_snames()[0];
  return name + " " + value_name(option);
}

void append_line(std::string& text, std::string_view line, int width, int indent) {
  const std::string margin(indent, ' ');
  int column = 0;
  while (!line.empty()) {
    const std::size_t end = std::min(line.find(' '), line.size());
    const int length = static_cast<int>(end);
    if (column > 0 && column + 1 + length > width) {
      text += '\n' + margin;
      column = 0;
    } else if (column > 0) {
      text += ' ';
      ++column;
    }
    text += line.substr(0, end);
    column += length;
    line.remove_prefix(std::min(end + 1, line.size()));
  }
}

}  // namespace

std::string wrap(std::string_view text, int width, int indent) {
  std::string wrapped;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    if (!line.empty() && line[0] == ' ') {
      wrapped += line;
    } else {
      append_line(wrapped, line, width, indent);
    }
    if (end < text.size()) wrapped += '\n';
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return wrapped;
}

HelpFormatter::HelpFormatter(int width) : width_(width) {
  label("Positionals", "Arguments");
}

std::string HelpFormatter::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const {
  return CLI::detail::find_and_replace(Formatter::make_help(app, std::move(name), mode), "\n\n\n", "\n\n");
}

std::string HelpFormatter::make_description(const CLI::App* app) const {
  return wrap(app->get_description(), width_, 0) + "\n\n";
}

std::string HelpFormatter::make_usage(const CLI::App* app, std::string name) const {
  std::string usage = "Usage: " + name;
  if (!app->get_subcommands({}).empty()) usage += " COMMAND";
  for (const CLI::Option* option : app->get_options()) {
    if (!option->get_positional()) continue;
    usage += option->get_required() ? " " + value_name(*option) : " [" + value_name(*option) + "...]";
  }
  for (const CLI::Option* option : app->get_options()) {
    if (option->nonpositional() && option->get_required()) usage += " " + usage_of(*option);
  }
  return usage + " [OPTIONS]\n";
}

std::string HelpFormatter::entry(const std::string& name, const std::string& meaning) const {
  std::string text = "  " + name;
  const bool narrow = width_ < 2 * kNameColumn;
  const int indent = narrow ? 6 : kNameColumn;
  if (narrow || static_cast<int>(text.size()) + 2 > indent) {
    text += '\n' + std::string(indent, ' ');
  } else {
    text.resize(indent, ' ');
  }
  return text + wrap(meaning, width_ - indent, indent) + '\n';
}

std::string HelpFormatter::make_option(const CLI::Option* option, bool is_positional) const {
  std::string meaning = option->get_description();
  for (const CLI::Option* other : option->get_excludes()) meaning += fmt::format(" (not with {})", other->get_name());
  return entry(name_of(*option, is_positional), meaning);
}

std::string HelpFormatter::make_subcommand(const CLI::App* sub) const {
  return entry(sub->get_name(), sub->get_description());
}

std::string HelpFormatter::make_footer(const CLI::App* app) const {
  return wrap(app->get_footer(), width_, 0) + '\n';
}

std::vector<std::string> words_of_help(const CLI::App& app, std::vector<std::string> words) {
  if (words.empty() || words[0] != "help") return words;
  words.erase(words.begin());
  const auto commands = app.get_subcommands({});
  const auto is_named = [&words](const CLI::App* command) { return command->get_name() == words[0]; };
  // CLI11 would explain the program where it does not know the command.
  if (words.empty() || std::any_of(commands.begin(), commands.end(), is_named)) words.emplace_back("--help");
  return words;
}

std::string explain(const CLI::App& app, const CLI::ParseError& error) {
  const auto parsed = app.get_subcommands();
  std::vector<std::string> extras = app.remaining(true);
  if (!extras.empty()) {
    // CLI11 lists what it does not know in no order; an option tells more than the value behind it.
    const auto option = std::find_if(extras.begin(), extras.end(), [](const auto& word) { return word[0] == '-'; });
    if (option != extras.end()) return fmt::format("there is no option '{}'", *option);
    if (parsed.empty()) return fmt::format("there is no command '{}'", extras.front());
    return fmt::format("unexpected argument '{}'", extras.front());
  }
  if (parsed.empty()) return "no command given";
  const std::string what = error.what();
  constexpr std::string_view kUnreadable = "Could not convert: ";
  const std::size_t value = what.find(" = ");
  if (what.rfind(kUnreadable, 0) == 0 && value != std::string::npos) {
    const std::string name = what.substr(kUnreadable.size(), value - kUnreadable.size());
    const CLI::Option* option = parsed[0]->get_option_no_throw(name);
    const bool whole = option != nullptr && value_name(*option) == "N";
    return fmt::format("{}: '{}' is not a {}number", name, what.substr(value + 3), whole ? "whole " : "");
  }
  return what;
}

}  // namespace selvage::cli
