/// What a front is to the method about the page, where the daemon has one.
#pragma once

#include <string>
#include <vector>

namespace tmcld {

/// A Peer of such a front is one, too.
class PagePlace {
 public:
  virtual ~PagePlace() = default;
  /// As a browser takes them.
  virtual const std::vector<std::string>& page_addresses() const = 0;
};

}  // namespace tmcld
