/// The certificate, the key and whom they trust, from the files of [http].
#pragma once

#include <memory>
#include <string>

#include <boost/asio/ssl/context.hpp>
#include <tl/expected.hpp>

#include "config/http_config.hpp"

namespace tmcld {

struct Tls {
  std::shared_ptr<boost::asio::ssl::context> context;  ///< Null: there is none.
  /// Why clients will not trust the certificate now; empty if they may.
  std::string age_problem;
  /// What would make it better; empty if nothing.
  std::string advice;
};

/// Errors: a sentence for a person.
tl::expected<Tls, std::string> tls_of(const HttpConfig& config);
/// An error of OpenSSL.
std::string tls_error_text(unsigned long error);

}  // namespace tmcld
