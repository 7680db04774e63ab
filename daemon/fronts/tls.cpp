#include "fronts/tls.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/x509.h>

namespace tmcld {
namespace {

namespace ssl = boost::asio::ssl;
using boost::system::error_code;

/// What the library of TLS has complained of.
std::string last_complaint() {
  const auto error = ERR_peek_last_error();
  ERR_clear_error();
  return error == 0 ? "it is not as it should be" : tls_error_text(error);
}

/// Of PEM, a form of text: "-----BEGIN CERTIFICATE-----" begins what it holds.
struct PemFile {
  std::string what;
  std::string path;
  std::string holds;
};
const char* const certificate_in_pem = "CERTIFICATE-----";
const char* const key_in_pem = "PRIVATE KEY-----";

/// Why OpenSSL has refused it, which of a file that is not there says "system lib".
std::string problem_of(const PemFile& file, const std::string& fault) {
  constexpr std::size_t most_bytes = 1U << 20U;
  const auto complaint = last_complaint();
  const auto name = file.what + ' ' + file.path;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> open(std::fopen(file.path.c_str(), "re"),
                                                             &std::fclose);
  std::string text(open ? most_bytes : 0, '\0');
  if (open) text.resize(std::fread(text.data(), 1, text.size(), open.get()));
  if (!open || std::ferror(open.get()) != 0)
    return name + " cannot be read: " + std::strerror(errno);
  if (text.find(file.holds) == std::string::npos)
    return name + " is not what it should be: it has no line '-----BEGIN " + file.holds + "'";
  return name + ' ' + fault + ": " + complaint;
}

/// Empty if it is good now.
std::string age_problem(SSL_CTX* context, const std::string& file) {
  const auto* certificate = SSL_CTX_get0_certificate(context);
  if (certificate == nullptr) return {};
  if (X509_cmp_current_time(X509_get0_notAfter(certificate)) < 0)
    return "the certificate " + file + " has run out: clients will not trust it; get a new one";
  if (X509_cmp_current_time(X509_get0_notBefore(certificate)) > 0)
    return "the certificate " + file + " is not valid yet: is the clock of this computer right?";
  return {};
}

/// Empty if the key is good for a server.
std::string advice(SSL_CTX* context, const std::string& file) {
  const auto* key = SSL_CTX_get0_privatekey(context);
  if (key == nullptr || EVP_PKEY_base_id(key) != EVP_PKEY_RSA) return {};
  return "the key " + file + " is for RSA (" + std::to_string(EVP_PKEY_bits(key)) +
         " bits): one for ECDSA (P-256) takes a small part of the time whenever a client connects; "
         "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 makes one";
}

}  // namespace

std::string tls_error_text(unsigned long error) {
  std::array<char, 256> text{};
  ERR_error_string_n(error, text.data(), text.size());
  const auto* reason = ERR_reason_error_string(error);
  return reason != nullptr ? reason : text.data();
}

tl::expected<Tls, std::string> tls_of(const HttpConfig& config) {
  Tls tls;
  if (config.certificate.empty()) return tls;
  tls.context = std::make_shared<ssl::context>(ssl::context::tls_server);
  auto& context = *tls.context;
  error_code error;
  const auto fail = [](const PemFile& file, const std::string& fault) {
    return tl::unexpected(problem_of(file, fault));
  };
  context.set_options(ssl::context::default_workarounds | ssl::context::no_sslv2 |
                          ssl::context::no_sslv3 | ssl::context::no_tlsv1 |
                          ssl::context::no_tlsv1_1 | SSL_OP_NO_RENEGOTIATION,
                      error);
  ERR_clear_error();
  context.use_certificate_chain_file(config.certificate, error);
  if (error)
    return fail({"the certificate", config.certificate, certificate_in_pem}, "cannot be used");
  context.use_private_key_file(config.key, ssl::context::pem, error);
  if (error)
    return fail({"the key", config.key, key_in_pem}, "does not go with " + config.certificate);
  // A thousand clients share what one needs while it speaks.
  SSL_CTX_set_mode(context.native_handle(), SSL_MODE_RELEASE_BUFFERS);
  tls.age_problem = age_problem(context.native_handle(), config.certificate);
  tls.advice = advice(context.native_handle(), config.key);
  if (config.client_ca.empty()) return tls;
  context.load_verify_file(config.client_ca, error);
  if (error)
    return fail({"the certificates of clients,", config.client_ca, certificate_in_pem},
                "cannot be used");
  context.set_verify_mode(ssl::verify_peer | ssl::verify_fail_if_no_peer_cert, error);
  return tls;
}

}  // namespace tmcld
