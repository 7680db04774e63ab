/// The whole terminal, for what is drawn anew again and again.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "errors.hpp"
#include "key.hpp"
#include "screen.hpp"

namespace tmclctl {

/// The terminal is as it was when this ends.
class FullScreen {
 public:
  /// Whether there is a terminal. Errors: no_terminal.
  static Result<void> look_for(const Screen& out);
  /// Errors: no_terminal, also for one that is not known.
  static Result<std::unique_ptr<FullScreen>> open(const Screen& out);
  FullScreen(const FullScreen&) = delete;
  FullScreen& operator=(const FullScreen&) = delete;
  ~FullScreen();

  int width() const;  ///< In columns, as it is now.
  /// Lines that do not fit are left out, and so is what does not fit of a line.
  void show(const std::vector<std::string>& lines);
  /// From now on take_key() gives releases of arrow and page keys, too, if the terminal can report
  /// them: those that speak kitty's keyboard protocol do.
  void report_releases();
  /// The next key that was pressed; nothing if none was.
  std::optional<Key> take_key();

 private:
  struct Terminal;
  explicit FullScreen(std::unique_ptr<Terminal> terminal);

  std::unique_ptr<Terminal> terminal_;
};

}  // namespace tmclctl
