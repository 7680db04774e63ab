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

/// Bytes "offset" and following.
Lookup<std::vector<std::uint8_t>> part_of(const Call& call, const Staged& staged) {
  const auto held = buffer_for(call, staged).size_for(call.peer);
  const auto offset = static_cast<std::size_t>(call.params.integer("offset"));
  if (offset != 0 && offset != held) {
    return tl::unexpected(param_error("bad_argument", "offset",
                                      held_by_client(staged, held) +
                                          ", so these cannot be those from " +
                                          std::to_string(offset) + " on",
                                      "begin again with offset 0"));
  }
  auto bytes = tmcl::from_hex(call.params.text("data"));
  if (!bytes)
    return tl::unexpected(param_error("bad_argument", "data", "'data': " + bytes.error()));
  if (offset + bytes->size() <= staged.most_bytes) return std::move(*bytes);
  return tl::unexpected(param_error(
      "out_of_range", "data",
      std::string(staged.what) + " has at most " + std::to_string(staged.most_bytes) + " bytes"));
}

}  // namespace

RpcResult stage_part(const Call& call, const Staged& staged) {
  const auto part = part_of(call, staged);
  if (!part) return tl::unexpected(part.error());
  auto& buffer = buffer_for(call, staged);
  if (call.params.integer("offset") == 0) buffer.begin(call.peer);
  buffer.append(*part);
  return boost::json::object{{"bytes", buffer.size_for(call.peer)}};
}

Lookup<std::vector<std::uint8_t>> take_staged(const Call& call, const Staged& staged) {
  auto& buffer = buffer_for(call, staged);
  const auto held = buffer.size_for(call.peer);
  const auto wanted = static_cast<std::size_t>(call.params.integer("bytes"));
  if (held == wanted) return buffer.take();
  return tl::unexpected(param_error(
      "bad_argument", "bytes", held_by_client(staged, held) + ", and not " + std::to_string(wanted),
      "hand it over by " + std::string(staged.method) + ", all of it, right before"));
}

}  // namespace tmcld
