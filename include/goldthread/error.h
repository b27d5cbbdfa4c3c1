// What can go wrong, as a value: a code for scripts, and what, where and cure for people.
#pragma once
#include <string>
#include <utility>
#include <variant>

namespace goldthread {

/// The kinds of failure, valued as the program's exit codes (design.md section 8).
enum class ErrorCode {
  kUsage = 2,          ///< wrong options or arguments
  kBadInput = 3,       ///< a file that cannot be read or makes no sense
  kNothingToBake = 4,  ///< no triangles, or no light
  kLimit = 5,          ///< out of memory, or a limit was reached with nothing to show
  kCannotWrite = 6,    ///< an output could not be written
  kCancelled = 130,    ///< stopped by the user
};

/// One failure. `line()` is the single line shown to a person.
struct Error {
  ErrorCode code = ErrorCode::kBadInput;
  std::string message;  ///< what is wrong
  std::string file;     ///< which file, empty when none
  std::string place;    ///< where in it: "accessor 3", "mesh 2 primitive 0"; may be empty
  std::string cure;     ///< what to do about it; may be empty

  /// "file: place: message; cure" on one line.
  std::string line() const {
    std::string text = file;
    if (!place.empty()) text += (text.empty() ? "" : ": ") + place;
    if (!message.empty()) text += (text.empty() ? "" : ": ") + message;
    if (!cure.empty()) text += "; " + cure;
    for (char& c : text)
      if (c == '\n' || c == '\r') c = ' ';
    return text;
  }
};

/// A value or an Error. Test with `if (!result)`, then `result.error()`; else `*result`.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}
  Result(Error error) : state_(std::move(error)) {}

  explicit operator bool() const { return state_.index() == 0; }
  T& operator*() & { return std::get<0>(state_); }
  const T& operator*() const& { return std::get<0>(state_); }
  T&& operator*() && { return std::get<0>(std::move(state_)); }
  T* operator->() { return &std::get<0>(state_); }
  const T* operator->() const { return &std::get<0>(state_); }
  const Error& error() const { return std::get<1>(state_); }

 private:
  std::variant<T, Error> state_;
};

/// Success, or an Error.
struct Nothing {};
using Status = Result<Nothing>;

}  // namespace goldthread
