/// Waiting for input of a descriptor, again and again, without memory: what serves hosts goes on
/// where there is none.
#pragma once

#include <cstddef>
#include <utility>

#include <boost/asio/bind_allocator.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "tmcl/in_room.hpp"

namespace tmcld {

/// Of one wait at a time.
struct WaitingRoom {
  alignas(std::max_align_t) tmcl::InRoom<void>::Room room{};
};

template <class OnInput>
void wait_for_input(boost::asio::posix::stream_descriptor& descriptor, WaitingRoom& room,
                    OnInput on_input) {
  descriptor.async_wait(
      boost::asio::posix::stream_descriptor::wait_read,
      boost::asio::bind_allocator(tmcl::InRoom<void>(room.room), std::move(on_input)));
}

}  // namespace tmcld
