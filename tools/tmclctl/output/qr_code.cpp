#include "output/qr_code.hpp"

#include <cstddef>
#include <memory>

#include <qrencode.h>

namespace tmclctl {
namespace {

// In modules: what ISO/IEC 18004 wants around it.
constexpr int margin = 4;

class Modules {
 public:
  explicit Modules(const std::string& text)
      : code_(QRcode_encodeString8bit(text.c_str(), 0, QR_ECLEVEL_L), QRcode_free) {}

  bool is_there() const { return code_ != nullptr; }
  int size() const { return code_->width + 2 * margin; }
  bool is_light(int row, int column) const {
    const int width = code_->width;
    const int y = row - margin;
    const int x = column - margin;
    if (x < 0 || y < 0 || x >= width || y >= width) return true;
    return (code_->data[static_cast<std::size_t>(y * width + x)] & 1) == 0;
  }

 private:
  std::unique_ptr<QRcode, decltype(&QRcode_free)> code_;
};

std::string half_blocks(const Modules& modules, int row) {
  std::string line;
  for (int column = 0; column < modules.size(); ++column) {
    const bool upper = modules.is_light(row, column);
    const bool lower = row + 1 < modules.size() && modules.is_light(row + 1, column);
    line += upper ? (lower ? "█" : "▀") : (lower ? "▄" : " ");
  }
  return line;
}

std::string wide_blocks(const Modules& modules, int row) {
  std::string line;
  for (int column = 0; column < modules.size(); ++column)
    line += modules.is_light(row, column) ? "##" : "  ";
  return line;
}

}  // namespace

std::string qr_code(const std::string& text, const Screen& screen) {
  const Modules modules(text);
  if (!modules.is_there()) return {};
  // White on black, whatever the terminal's own colours are.
  const std::string before = screen.colour ? "\x1b[97;40m" : "";
  const std::string after = screen.colour ? "\x1b[0m\n" : "\n";
  std::string lines;
  for (int row = 0; row < modules.size(); row += screen.utf8 ? 2 : 1)
    lines += before + (screen.utf8 ? half_blocks(modules, row) : wide_blocks(modules, row)) + after;
  return lines;
}

}  // namespace tmclctl
