/// The conversations with the modules of one bus: whether each is in step (lane.hpp), whose it is
/// (custody.hpp), and what is under way to it (channel.hpp).
#pragma once

#include <map>

#include "engine/channel.hpp"
#include "engine/custody.hpp"
#include "engine/lane.hpp"

namespace tmcl::engine {

struct Conversation {
  ModuleAddress address{};
  Lane lane{};
  Custody custody{};
  Channel own_channel{};  ///< Used on CAN.
};

/// With every module that was ever addressed; at most one for each reply byte.
class Conversations {
 public:
  explicit Conversations(Framing framing) : framing_(framing) {}

  Framing framing() const { return framing_; }
  Conversation& with(ModuleAddress address) {
    if (auto* known = find(reply_byte(address))) return *known;
    return all_.emplace(reply_byte(address), Conversation{address}).first->second;
  }
  /// Null if no request ever went to it.
  Conversation* find(std::uint8_t module) {
    const auto found = all_.find(module);
    return found == all_.end() ? nullptr : &found->second;
  }
  Channel& line() { return line_; }
  Channel& channel_of(Conversation& conversation) {
    return framing_ == Framing::serial ? line_ : conversation.own_channel;
  }
  Channel& channel_to(ModuleAddress address) { return channel_of(with(address)); }

  std::map<std::uint8_t, Conversation>& all() { return all_; }
  const std::map<std::uint8_t, Conversation>& all() const { return all_; }
  template <class Act>
  void for_each_channel(Act act) {
    act(line_);
    for (auto& [byte, conversation] : all_) act(conversation.own_channel);
  }
  template <class Act>
  void for_each_channel(Act act) const {
    act(line_);
    for (const auto& [byte, conversation] : all_) act(conversation.own_channel);
  }
  /// The first channel that `wanted` is true of; null if there is none.
  template <class Wanted>
  Channel* find_channel(Wanted wanted) {
    Channel* found = nullptr;
    for_each_channel([&](Channel& channel) {
      if (found == nullptr && wanted(channel)) found = &channel;
    });
    return found;
  }

 private:
  friend class EngineState;  ///< Of tests: tells two apart.
  Framing framing_;
  Channel line_;
  std::map<std::uint8_t, Conversation> all_;
};

}  // namespace tmcl::engine
