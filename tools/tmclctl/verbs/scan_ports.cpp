// scan --bauds and --auto: which baud rate, address and port lead to modules.
#include <algorithm>

#include <fmt/format.h>

#include "api/views.hpp"
#include "connection/serial_port.hpp"
#include "output/print.hpp"
#include "output/progress_line.hpp"
#include "tmcl/harmless_question.hpp"
#include "tmcl/model.hpp"
#include "tmcl/ports.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

constexpr std::uint16_t last_serial_address = 255;
// As that of a scan, of a bus whose answers take long.
constexpr int search_share_of_reply_timeout = 4;

std::string model_of(const FoundAtRate& found) {
  const auto* model = tmcl::find_model(found.version.model);
  return model_text(model != nullptr ? model->name : "", found.version.model);
}

std::string link_at(const std::string& device, std::uint32_t baud) {
  return to_string(tmcl::LinkName(tmcl::SerialName{device, baud}));
}

Result<BaudSearchOptions> search_options(const ScanRange& range, const Where& where) {
  if (range.first < 1 || range.last > last_serial_address)
    return tl::unexpected(
        usage_error("out_of_range", "on serial lines there are the addresses 1 to 255"));
  BaudSearchOptions options;
  options.first = static_cast<std::uint8_t>(range.first);
  options.last = static_cast<std::uint8_t>(range.last);
  const std::chrono::milliseconds given(where.reply_timeout_ms.value_or(0));
  options.reply_timeout =
      std::max<tmcl::Duration>(options.reply_timeout, given / search_share_of_reply_timeout);
  return options;
}

Result<std::string> device_of(const Where& where) {
  if (where.direct.empty()) {
    return tl::unexpected(usage_error(
        "needs_direct",
        "'scan --bauds' needs a port for itself: tmcld has its ports at the baud rates of its "
        "configuration",
        "stop tmcld (sudo systemctl stop tmcld), then 'tmclctl --direct serial:DEVICE scan "
        "--bauds'"));
  }
  const auto link = attempt(tmcl::parse_link_name(where.direct));
  if (!link) return tl::unexpected(link.error());
  const auto* serial = std::get_if<tmcl::SerialName>(&*link);
  if (serial != nullptr) return serial->device;
  return tl::unexpected(usage_error("no_baud_rate",
                                    fmt::format("'{}' has no baud rate to look for", where.direct),
                                    "only a link serial:DEVICE has one"));
}

/// Those that no program holds; what is left out is told.
std::vector<std::string> free_devices(Output& output) {
  std::vector<std::string> devices;
  for (const auto& port : tmcl::list_ports()) {
    const auto holder = holder_of(port);
    if (!holder.empty()) {
      output.err << fmt::format("{} is left out: {} holds it\n", link_to(port), holder);
    } else if (port.device.empty()) {
      output.err << fmt::format("{0} has no baud rate: 'tmclctl --direct {0} scan'\n",
                                link_to(port));
    } else {
      devices.push_back(port.device);
    }
  }
  return devices;
}

class PortScan {
 public:
  PortScan(const BaudSearchOptions& options, Output& output, Host& host)
      : options_(options), output_(output), host_(host), line_(output) {}

  void look_at(const std::string& device);
  ExitCode end();

 private:
  void tell_found(const std::string& device, const FoundAtRate& found);
  void tell_silence(const std::string& device, const tmcl::HeardVerdict& heard);
  void tell_failure(const std::string& device, const Error& error);

  BaudSearchOptions options_;
  Output& output_;
  Host& host_;
  ProgressLine line_;
  GrowingTable table_{{"LINK", "ADDRESS", "MODEL", "FIRMWARE"}, {30, 7, 10, 8}};
  json::array modules_, silent_, failed_;
  ExitCode exit_ = ExitCode::done;
};

void PortScan::tell_found(const std::string& device, const FoundAtRate& found) {
  const auto link = link_at(device, found.baud);
  modules_.push_back(json::object{{"link", link},
                                  {"baud", found.baud},
                                  {"address", found.address},
                                  {"model", model_of(found)},
                                  {"model_number", found.version.model},
                                  {"firmware", to_string(found.version)}});
  line_.clear();
  if (output_.json) return;
  table_.add({link, std::to_string(found.address), model_of(found), to_string(found.version)},
             output_.out);
}

void PortScan::tell_silence(const std::string& device, const tmcl::HeardVerdict& heard) {
  using enum tmcl::HeardKind;
  auto view = tmcld::view_of(heard, "serial:" + device);
  if (heard.kind == nothing || heard.kind == other_baud_rate || heard.kind == noise)
    view.hint =
        "check the supply, the cabling (A and B, or RX and TX swapped?) and whether a module is "
        "on this port; all baud rates were tried";
  if (heard.kind == other_baud_rate)
    view.meaning = fmt::format(
        "{} bytes without a meaning came, at all baud rates: noise, or two modules have one "
        "address",
        heard.bytes);
  silent_.push_back(
      json::object{{"link", "serial:" + device}, {"heard", tmcl::api::to_json(view)}});
  if (output_.json) return;
  output_.err << fmt::format("No module answered on serial:{}: {}.\n", device, view.meaning);
  if (view.hint) output_.err << fmt::format("  Try: {}.\n", *view.hint);
}

void PortScan::tell_failure(const std::string& device, const Error& error) {
  exit_ = std::max(exit_, exit_code_of(error));
  failed_.push_back(json::object{{"link", "serial:" + device}, {"error", error_document(error)}});
  if (!output_.json)
    output_.err << fmt::format("tmclctl: serial:{} was not scanned: {}\n", device,
                               error_text(error));
}

void PortScan::look_at(const std::string& device) {
  const auto seconds = std::chrono::ceil<std::chrono::seconds>(longest_search(options_)).count();
  if (!output_.json)
    output_.err << fmt::format("serial:{}: {} baud rates, addresses {} to {}, {} s at most\n",
                               device, tmcl::serial_rates.size(), options_.first, options_.last,
                               seconds);
  const auto before = modules_.size();
  SerialPort port(device);
  BaudSearchNews news;
  news.found = [&](const FoundAtRate& found) { tell_found(device, found); };
  news.asked = [&](std::uint32_t baud, std::uint8_t address) {
    line_.show(fmt::format("serial:{} at {} baud: address {}", device, baud, address));
  };
  news.cancelled = [this] { return host_.signal() != 0; };
  const auto heard = search_bauds(port, options_, news);
  line_.clear();
  if (!heard) return tell_failure(device, heard.error());
  if (modules_.size() == before && host_.signal() == 0) tell_silence(device, *heard);
}

ExitCode PortScan::end() {
  if (modules_.empty() && failed_.empty()) exit_ = ExitCode::not_sent;
  if (output_.json)
    print_json({{"modules", std::move(modules_)},
                {"failed", std::move(failed_)},
                {"silent", std::move(silent_)}},
               output_);
  return exit_;
}

}  // namespace

Result<ExitCode> scan_ports(const verb::Scan& verb, const Where& where, Output& output,
                            Host& host) {
  const auto options = search_options(verb.range, where);
  if (!options) return tl::unexpected(options.error());
  std::vector<std::string> devices;
  if (verb.all_ports && !where.direct.empty())
    return tl::unexpected(
        usage_error("bad_option", "--auto looks at all ports: leave --direct out"));
  if (verb.all_ports) {
    devices = free_devices(output);
  } else {
    const auto device = device_of(where);
    if (!device) return tl::unexpected(device.error());
    devices.push_back(*device);
  }
  PortScan scan(*options, output, host);
  for (const auto& device : devices) {
    scan.look_at(device);
    if (host.signal() != 0)
      return tl::unexpected(interrupted_error(host.signal(), "the search was ended", ""));
  }
  if (devices.empty() && !output.json) output.err << "There is no serial port to look at.\n";
  return scan.end();
}

}  // namespace tmclctl
