/// What a front that lets clients in by tokens is to the methods about these.
#pragma once

#include <memory>

namespace tmcld {

class Tokens;

/// A Peer of such a front is one, too.
class TokenKeeper {
 public:
  virtual ~TokenKeeper() = default;
  /// Null if there are none.
  virtual const std::shared_ptr<Tokens>& tokens() const = 0;
};

}  // namespace tmcld
