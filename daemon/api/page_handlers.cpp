#include "api/page_handlers.hpp"

#include "api/page_place.hpp"

namespace tmcld::handlers {

Answer<page::Find> find_page(Call& call, const page::Find&) {
  const auto* place = dynamic_cast<const PagePlace*>(call.peer.get());
  page::Addresses found;
  if (place != nullptr) found.addresses = place->page_addresses();
  co_return found;
}

}  // namespace tmcld::handlers
