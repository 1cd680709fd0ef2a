#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace selvage {

/// The one exception type of the project: raised where input comes in (mesh construction, file reading,
/// public calls).
///
/// `what()` is one line: "where: what; remedy". `where` names a file with its line or byte offset, or an element.
class Error : public std::runtime_error {
 public:
  /// @param where   file and line or byte offset, or element number; may be empty
  /// @param what    what is wrong
  /// @param remedy  what to do about it; may be empty
  Error(std::string_view where, std::string_view what, std::string_view remedy = {});
};

/// An Error that is no fault of the input: the system refuses to write, on a full disk, say.
class SystemError : public Error {
 public:
  using Error::Error;
};

}  // namespace selvage
