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
  bool reports_releases = false;
};

namespace {

/// Arrow and page keys as they are sent with the kind of the event: CSI NUMBER ; LOCKS : EVENT END.
struct EventKey {
  int code;
  const char* number;
  char end;
};
constexpr EventKey event_keys[] = {{KEY_LEFT, "1", 'D'},  {KEY_RIGHT, "1", 'C'},
                                   {KEY_UP, "1", 'A'},    {KEY_DOWN, "1", 'B'},
                                   {KEY_PPAGE, "5", '~'}, {KEY_NPAGE, "6", '~'}};
/// With neither, with Caps Lock, with Num Lock, with both.
constexpr int event_locks[] = {1, 65, 129, 193};
constexpr int event_press = 1;
constexpr int event_repeat = 2;
constexpr int event_release = 3;
/// Added to the code of a key; ncurses itself has none as great.
constexpr int released = 0x1000;

// "CSI > 2 u" asks for the kinds of events, on top of what was asked for before; "CSI < u" ends
// that. Other terminals take no notice.
constexpr const char* ask_for_events = "\x1b[>2u";
constexpr const char* end_of_events = "\x1b[<u";

void write_to_terminal(const char* text) {
  std::fputs(text, stdout);
  std::fflush(stdout);
}

void define_events_of(const EventKey& key) {
  for (const int locks : event_locks)
    for (const int event : {event_press, event_repeat, event_release})
      ::define_key(fmt::format("\x1b[{};{}:{}{}", key.number, locks, event, key.end).c_str(),
                   event == event_release ? key.code + released : key.code);
  // A press without locks has neither, whatever keypad() asked for.
  const bool is_arrow = key.end != '~';
  if (is_arrow) ::define_key(fmt::format("\x1b[{}", key.end).c_str(), key.code);
}

Error no_terminal(std::string message) {
  return usage_error("no_terminal", std::move(message),
                     "'tmclctl watch --all' writes lines, to anywhere");
}

Key::Kind kind_of(int code) {
  switch (code) {
    case KEY_LEFT: return Key::Kind::left;
    case KEY_RIGHT: return Key::Kind::right;
    case KEY_UP: return Key::Kind::up;
    case KEY_DOWN: return Key::Kind::down;
    case KEY_PPAGE: return Key::Kind::page_up;
    case KEY_NPAGE: return Key::Kind::page_down;
    default: return Key::Kind::other;
  }
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
  if (terminal_->reports_releases) write_to_terminal(end_of_events);
  ::endwin();
  ::delscreen(terminal_->screen);
}

void FullScreen::report_releases() {
  // Each screen of a terminal has its own: this is about the one that is drawn on.
  ::refresh();
  for (const auto& key : event_keys) define_events_of(key);
  terminal_->reports_releases = true;
  write_to_terminal(ask_for_events);
}

int FullScreen::width() const { return getmaxx(stdscr); }

void FullScreen::show(const std::vector<std::string>& lines) {
  ::erase();
  for (int y = 0; y < getmaxy(stdscr) && y < static_cast<int>(lines.size()); ++y)
    ::mvaddstr(y, 0, fmt::format("{:.{}}", lines[static_cast<std::size_t>(y)], width()).c_str());
  ::refresh();
}

std::optional<Key> FullScreen::take_key() {
  const int code = ::getch();
  if (code == ERR) return std::nullopt;
  // It takes note of a new size.
  if (code == KEY_RESIZE) return take_key();
  const bool is_letter = code > 0 && code <= std::numeric_limits<char>::max();
  if (is_letter) return Key{Key::Kind::letter, static_cast<char>(code)};
  Key key;
  key.is_release = code >= released;
  key.kind = kind_of(key.is_release ? code - released : code);
  return key;
}

}  // namespace tmclctl
