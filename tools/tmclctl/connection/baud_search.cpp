#include "baud_search.hpp"

#include <algorithm>
#include <array>

#include "tmcl/harmless_question.hpp"
#include "tmcl/serial_decoder.hpp"

namespace tmclctl {
namespace {

using tmcl::Traffic;

constexpr long bits_of_exchange = 2 * 10 * long{tmcl::serial_datagram_size};

// What modules have as a rule comes first.
constexpr std::array<std::uint32_t, tmcl::serial_rates.size()> rates_by_likelihood{
    9'600,  115'200, 57'600, 38'400,  19'200,  230'400,
    14'400, 28'800,  76'800, 250'000, 500'000, 1'000'000};

tmcl::Duration time_of_exchange(std::uint32_t baud, tmcl::Duration reply_timeout) {
  return std::chrono::nanoseconds(std::chrono::seconds(bits_of_exchange)) / baud + reply_timeout;
}

class BaudSearch {
 public:
  BaudSearch(SearchedPort& port, const BaudSearchOptions& options, const BaudSearchNews& news)
      : port_(port), options_(options), news_(news) {}

  Result<tmcl::HeardVerdict> run() {
    for (const auto baud : rates_by_likelihood) {
      auto found = ask_all(baud, options_.first, options_.first);
      if (found && *found && options_.first < options_.last)
        found = ask_all(baud, options_.first + 1U, options_.last).map([](bool) { return true; });
      if (!found) return tl::unexpected(found.error());
      if (*found) return tmcl::HeardVerdict{tmcl::HeardKind::answers};
    }
    for (const auto baud : rates_by_likelihood) {
      const auto found = ask_all(baud, options_.first + 1U, options_.last);
      if (!found) return tl::unexpected(found.error());
      if (*found) return tmcl::HeardVerdict{tmcl::HeardKind::answers};
    }
    return heard_;
  }

 private:
  /// Whether a module answered at this rate.
  Result<bool> ask_all(std::uint32_t baud, unsigned first, unsigned last) {
    if (first > last) return false;
    if (auto opened = port_.open(baud); !opened) return tl::unexpected(opened.error());
    tmcl::Heard heard;
    bool any = false;
    for (unsigned address = first; address <= last; ++address) {
      if (news_.cancelled && news_.cancelled()) break;
      const auto answered = ask(baud, static_cast<std::uint8_t>(address), heard);
      if (!answered) return tl::unexpected(answered.error());
      any = any || *answered;
    }
    note(heard.verdict());
    return any;
  }

  /// The kinds stand in the order in which they say less, but for the first two.
  void note(const tmcl::HeardVerdict& heard) {
    using enum tmcl::HeardKind;
    if (heard.kind == nothing || heard.kind == answers) return;
    if (heard_.kind == nothing || heard.kind < heard_.kind) heard_ = heard;
  }

  /// Stays for the whole time, also when it was answered: between two questions the line is silent.
  Result<bool> ask(std::uint32_t baud, std::uint8_t address, tmcl::Heard& heard) {
    if (news_.asked) news_.asked(baud, address);
    const auto question = tmcl::harmless_question(address, baud);
    const auto until = port_.now() + time_of_exchange(baud, options_.reply_timeout);
    heard.note({port_.now(), Traffic::Direction::out, 0, false, question});
    if (auto sent = port_.send(question); !sent) return tl::unexpected(sent.error());
    tmcl::SerialDecoder decoder;
    bool answered = false;
    for (auto now = port_.now(); now < until; now = port_.now()) {
      std::array<std::uint8_t, 256> buffer{};
      const auto size = port_.receive(buffer, until - now);
      if (!size) return tl::unexpected(size.error());
      const auto bytes = std::span(buffer).first(*size);
      heard.note({port_.now(), Traffic::Direction::in, 0, false, bytes});
      for (const auto byte : bytes) {
        const auto item = decoder.push(byte);
        if (item && !answered) answered = tell_if_answer(*item, baud, address);
      }
    }
    return answered;
  }

  bool tell_if_answer(const tmcl::SerialItem& item, std::uint32_t baud, std::uint8_t address) {
    const auto* reply = std::get_if<tmcl::Reply>(&item);
    const bool answers = reply != nullptr && reply->module == address &&
                         reply->command == tmcl::Command::GET_FIRMWARE_VERSION;
    if (!answers) return false;
    // A module that knows the command but not this form is there all the same.
    const auto version = is_success(reply->status) ? tmcl::version_from_value(reply->value)
                                                   : tmcl::FirmwareVersion{};
    if (news_.found) news_.found({baud, address, version});
    return true;
  }

  SearchedPort& port_;
  const BaudSearchOptions& options_;
  const BaudSearchNews& news_;
  tmcl::HeardVerdict heard_;
};

}  // namespace

tmcl::Duration longest_search(const BaudSearchOptions& options) {
  tmcl::Duration sum{};
  const int addresses = options.last - options.first + 1;
  for (const auto baud : rates_by_likelihood)
    sum += time_of_exchange(baud, options.reply_timeout) * addresses;
  return sum;
}

Result<tmcl::HeardVerdict> search_bauds(SearchedPort& port, const BaudSearchOptions& options,
                                        const BaudSearchNews& news) {
  return BaudSearch(port, options, news).run();
}

}  // namespace tmclctl
