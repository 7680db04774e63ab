/// A client by HTTP: its requests, its calls, and the WebSocket that it may become.
#pragma once

#include <memory>

#include <boost/asio/ip/tcp.hpp>

#include "fronts/http_admission.hpp"
#include "fronts/http_connections.hpp"
#include "fronts/tls.hpp"

namespace tmcld {

/// Serves a new connection. `tls`: null for a port without.
void begin_http_connection(boost::asio::ip::tcp::socket socket,
                           std::shared_ptr<boost::asio::ssl::context> tls, HttpConnectionInfo info,
                           std::shared_ptr<HttpConnections> connections);

}  // namespace tmcld
