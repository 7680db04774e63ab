/// An allocator that gives one room, for what must not fail where there is no memory.
#pragma once

#include <array>
#include <cstddef>
#include <new>

namespace tmcl {

/// Gives the room once. Enough for what is handed to an executor: tests hold that.
template <class T>
struct InRoom {
  using value_type = T;
  using Room = std::array<std::byte, 256>;

  explicit InRoom(Room& its_room) : room(&its_room) {}
  template <class Other>
  InRoom(const InRoom<Other>& other) : room(other.room) {}
  T* allocate(std::size_t count) {
    const auto bytes = count * sizeof(T);
    return static_cast<T*>(bytes <= room->size() ? room->data() : ::operator new(bytes));
  }
  void deallocate(T* given, std::size_t) {
    if (static_cast<void*>(given) != room->data()) ::operator delete(given);
  }
  template <class Other>
  bool operator==(const InRoom<Other>& other) const {
    return room == other.room;
  }

  Room* room;
};

}  // namespace tmcl
