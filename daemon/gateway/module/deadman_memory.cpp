#include "gateway/module/deadman_memory.hpp"

#include <algorithm>
#include <utility>

#include <boost/json/parse.hpp>
#include <boost/json/value_to.hpp>

#include "async/elsewhere.hpp"
#include "gateway/store/state_file.hpp"
#include "tmcl/json_text.hpp"

namespace tmcld {
namespace {

namespace json = boost::json;

bool is_same_module(const KnownDeadman& one, const KnownDeadman& other) {
  return one.bus == other.bus && one.address == other.address && one.version == other.version;
}

json::object to_json(const KnownDeadman& known) {
  json::object object{{"bus", known.bus},
                      {"address", number(known.address)},
                      {"model", known.version.model},
                      {"firmware", json::array{known.version.major, known.version.minor}},
                      {"ms", known.set_ms}};
  if (known.stops_after_ms) object["measured"] = *known.stops_after_ms;
  return object;
}

/// Throws if it is none.
KnownDeadman known_from(const json::value& value) {
  KnownDeadman known{json::value_to<std::string>(value.at("bus")),
                     tmcl::ModuleAddress{value.at("address").to_number<std::uint16_t>()}};
  known.version.model = value.at("model").to_number<std::uint16_t>();
  const auto& firmware = value.at("firmware");
  known.version.major = firmware.at(0).to_number<decltype(known.version.major)>();
  known.version.minor = firmware.at(1).to_number<decltype(known.version.minor)>();
  known.set_ms = value.at("ms").to_number<std::int32_t>();
  if (const auto* measured = value.as_object().if_contains("measured"))
    known.stops_after_ms = measured->to_number<std::int32_t>();
  return known;
}

std::string text_of(const std::vector<KnownDeadman>& all) {
  json::array array;
  for (const auto& known : all) array.push_back(to_json(known));
  return tmcl::json_text(json::object{{"version", 1}, {"modules", std::move(array)}}) + "\n";
}

tl::expected<std::vector<KnownDeadman>, std::string> read_known(const std::string& path) {
  const auto text = read_state_file(path);
  if (!text) return tl::unexpected(text.error());
  std::vector<KnownDeadman> all;
  if (!*text) return all;
  try {
    const auto document = json::parse(**text);
    for (const auto& one : document.at("modules").as_array()) all.push_back(known_from(one));
    return all;
  } catch (const std::exception& error) {
    return tl::unexpected(path + " is damaged: " + error.what());
  }
}

}  // namespace

std::shared_ptr<DeadmanMemory> DeadmanMemory::open(std::string path, const LogSink& log) {
  std::shared_ptr<DeadmanMemory> memory(new DeadmanMemory(std::move(path), log));
  if (memory->path_.empty()) return memory;
  auto known = read_known(memory->path_);
  if (known) memory->known_ = std::move(*known);
  if (!known) {
    log(LogLevel::warning, "what tests of deadmen have found is not known any more: " +
                               known.error() + "; 'tmclctl deadman test AXIS' tests again");
  }
  return memory;
}

const KnownDeadman* DeadmanMemory::find(std::string_view bus, tmcl::ModuleAddress address,
                                        const tmcl::FirmwareVersion& version) const {
  const KnownDeadman wanted{std::string(bus), address, version};
  const auto found = std::ranges::find_if(
      known_, [&](const auto& known) { return is_same_module(known, wanted); });
  return found == known_.end() ? nullptr : &*found;
}

void DeadmanMemory::note(KnownDeadman known) {
  std::erase_if(known_, [&](const auto& one) { return is_same_module(one, known); });
  if (known_.size() == most_known_deadmen) known_.erase(known_.begin());
  known_.push_back(std::move(known));
}

boost::asio::awaitable<void> DeadmanMemory::write(std::shared_ptr<DeadmanMemory> self) {
  if (self->path_.empty()) co_return;
  auto work = [path = self->path_, text = text_of(self->known_)] {
    return replace_state_file(path, text);
  };
  const auto failure = co_await elsewhere(self->writer_, std::move(work));
  if (failure.empty()) co_return;
  self->log_(LogLevel::warning, "what a test of a deadman has found is not kept: " + failure);
}

}  // namespace tmcld
