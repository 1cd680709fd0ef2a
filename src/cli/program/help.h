#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace selvage::cli {

/// Breaks the lines of a text at blanks so that none is wider than `width`, where words allow it; what is broken off
/// goes on behind `indent` blanks, which do not count. Lines that begin with a blank are laid out already and stay.
std::string wrap(std::string_view text, int width, int indent);

/// Help in two columns that fit the terminal, with a usage line of all that a command needs.
class HelpFormatter : public CLI::Formatter {
 public:
  explicit HelpFormatter(int width);

  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
  std::string make_description(const CLI::App* app) const override;
  std::string make_usage(const CLI::App* app, std::string name) const override;
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_subcommand(const CLI::App* sub) const override;
  std::string make_footer(const CLI::App* app) const override;

 private:
  /// A name and what it means, one beside the other or one above the other.
  std::string entry(const std::string& name, const std::string& meaning) const;

  int width_;
};

/// The help that is asked for by the words `help [COMMAND]`, as options: `[COMMAND] --help`.
std::vector<std::string> words_of_help(const CLI::App& app, std::vector<std::string> words);

/// The error in a command line, in one line without its end.
std::string explain(const CLI::App& app, const CLI::ParseError& error);

}  // namespace selvage::cli
