#include "full_screen.hpp"

#include <unistd.h>

#include <clocale>
#include <cstdio>
#include <limits>

#define NCURSES_NOMACROS  // they would be called erase and refresh
#include <curses.h>
#include <fmt/format.h>

namespace tmclctl {

struct FullScreen::Terminal {
  SCREEN* screen;
};

namespace {

Error no_terminal(std::string message) {
  return usage_error("no_terminal", std::move(message),
                     "'tmclctl watch --all' writes lines, to anywhere");
}

}  // namespace

Result<void> FullScreen::look_for(const Screen& out) {
  if (out.terminal && ::isatty(STDIN_FILENO) != 0) return {};
  return tl::unexpected(no_terminal("this needs a terminal to draw on"));
}

Result<std::unique_ptr<FullScreen>> FullScreen::open(const Screen& out) {
  const auto found = look_for(out);
  if (!found) return tl::unexpected(found.error());
  std::setlocale(LC_CTYPE, "");
  auto* screen = ::newterm(nullptr, stdout, stdin);
  if (screen == nullptr)
    return tl::unexpected(no_terminal("this terminal is not known: what is $TERM?"));
  ::cbreak();
  ::noecho();
  ::curs_set(0);
  ::keypad(stdscr, TRUE);
  ::nodelay(stdscr, TRUE);
  // What may be the beginning of an arrow; alone it is a key as well.
  constexpr int time_for_escape_ms = 50;
  ::set_escdelay(time_for_escape_ms);
  return std::unique_ptr<FullScreen>(new FullScreen(std::make_unique<Terminal>(Terminal{screen})));
}

FullScreen::FullScreen(std::unique_ptr<Terminal> terminal) : terminal_(std::move(terminal)) {}

FullScreen::~FullScreen() {
  ::endwin();
  ::delscreen(terminal_->screen);
}

int FullScreen::width() const { return getmaxx(stdscr); }

void FullScreen::show(const std::vector<std::string>& lines) {
  ::erase();
  for (int y = 0; y < getmaxy(stdscr) && y < static_cast<int>(lines.size()); ++y)
    ::mvaddstr(y, 0, fmt::format("{:.{}}", lines[static_cast<std::size_t>(y)], width()).c_str());
  ::refresh();
}

std::optional<Key> FullScreen::take_key() {
  const int key = ::getch();
  switch (key) {
    case ERR: return std::nullopt;
    // It takes note of a new size.
    case KEY_RESIZE: return take_key();
    case KEY_LEFT: return Key{Key::Kind::left};
    case KEY_RIGHT: return Key{Key::Kind::right};
    case KEY_UP: return Key{Key::Kind::up};
    case KEY_DOWN: return Key{Key::Kind::down};
    case KEY_PPAGE: return Key{Key::Kind::page_up};
    case KEY_NPAGE: return Key{Key::Kind::page_down};
    default: break;
  }
  const bool is_letter = key > 0 && key <= std::numeric_limits<char>::max();
  return is_letter ? Key{Key::Kind::letter, static_cast<char>(key)} : Key{};
}

}  // namespace tmclctl
