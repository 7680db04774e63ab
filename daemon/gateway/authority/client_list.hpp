/// Who is connected now. Each front enters its clients, and says how one is when that is asked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "config/config.hpp"
#include "gateway/authority/leases.hpp"

namespace tmcld {

struct ConnectedClient {
  std::string door{};     ///< By which it came: socket, http, websocket, port or process.
  std::string address{};  ///< Of the network; empty: of this computer.
  std::string token{};    ///< By which it was let in; empty: by none.
  std::optional<std::uint32_t> uid{};
  std::optional<std::int32_t> pid{};
  Role role = Role::configure;
  bool relays = false;       ///< It may speak for users, and has not said for which.
  std::size_t requests = 0;  ///< Of it that are in progress.
};

/// Thread safety: none.
class ClientList {
 public:
  using Look = std::function<ConnectedClient()>;
  struct Row {
    tmcl::TimePoint since{};
    Look look;
  };

  /// On the list for as long as it lives.
  class Entry {
   public:
    Entry() = default;
    Entry(std::shared_ptr<ClientList> list, std::uint64_t number)
        : list_(std::move(list)), number_(number) {}
    Entry(const Entry&) = delete;
    Entry& operator=(const Entry&) = delete;
    ~Entry() { leave(); }
    void leave() noexcept {
      if (list_) list_->rows_.erase(number_);
      list_.reset();
    }

   private:
    std::shared_ptr<ClientList> list_;
    std::uint64_t number_ = 0;
  };

  /// `look` is called while the entry lives. The client must not be on the list.
  static Entry enter(std::shared_ptr<ClientList> list, std::uint64_t client, tmcl::TimePoint now,
                     Look look) {
    list->rows_.emplace(client, Row{now, std::move(look)});
    return {std::move(list), client};
  }
  /// By their numbers: who came first is first.
  const std::map<std::uint64_t, Row>& rows() const { return rows_; }

 private:
  std::map<std::uint64_t, Row> rows_;
};

}  // namespace tmcld
