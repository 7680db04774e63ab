#include "api/staging.hpp"

#include "tmcl/hex.hpp"

namespace tmcld {
namespace {

std::string held_by_client(const Staged& staged, std::size_t bytes) {
  return "of " + std::string(staged.what) + " of this client there are " + std::to_string(bytes) +
         " bytes";
}

UploadBuffer& buffer_for(const Call& call, const Staged& staged) {
  return *call.gateway.*staged.buffer;
}

/// The bytes of a part, which follow those that are there.
Result<std::vector<std::uint8_t>> bytes_of(const Call& call, const Part& part,
                                           const Staged& staged) {
  const auto held = buffer_for(call, staged).size_for(call.peer);
  const auto offset = static_cast<std::size_t>(part.offset);
  if (offset != 0 && offset != held) {
    return tl::unexpected(param_error<&api::firmware::Stage::offset>(
        "bad_argument",
        held_by_client(staged, held) + ", so these cannot be those from " + std::to_string(offset) +
            " on",
        "begin again with offset 0"));
  }
  constexpr auto data = api::name_of<&api::firmware::Stage::data>();
  auto bytes = tmcl::from_hex(part.data);
  if (!bytes) return tl::unexpected(param_error("bad_argument", data, "'data': " + bytes.error()));
  if (offset + bytes->size() <= staged.most_bytes) return std::move(*bytes);
  return tl::unexpected(param_error(
      "out_of_range", data,
      std::string(staged.what) + " has at most " + std::to_string(staged.most_bytes) + " bytes"));
}

}  // namespace

Result<api::HandedOver> stage_part(const Call& call, const Part& part, const Staged& staged) {
  const auto bytes = bytes_of(call, part, staged);
  if (!bytes) return tl::unexpected(bytes.error());
  auto& buffer = buffer_for(call, staged);
  if (part.offset == 0) buffer.begin(call.peer);
  buffer.append(*bytes);
  return api::HandedOver{static_cast<std::int32_t>(buffer.size_for(call.peer))};
}

Result<std::vector<std::uint8_t>> take_staged(const Call& call, const Staged& staged,
                                              std::size_t bytes) {
  auto& buffer = buffer_for(call, staged);
  const auto held = buffer.size_for(call.peer);
  if (held == bytes) return buffer.take();
  return tl::unexpected(param_error<&api::path::Run::bytes>(
      "bad_argument", held_by_client(staged, held) + ", and not " + std::to_string(bytes),
      "hand it over by " + std::string(staged.method) + ", all of it, right before"));
}

}  // namespace tmcld
