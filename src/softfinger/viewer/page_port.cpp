#include "softfinger/viewer/page_port.hpp"

#include "softfinger/viewer/server/bound_port.hpp"

#include <fmt/format.h>

#include <utility>

#include "softfinger/base/error.hpp"

namespace softfinger {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

PagePort::Implementation::Implementation(ServerOptions of) : options(std::move(of)) {
  if (options.certificate.is_given()) {
    tls = std::make_unique<asio::ssl::context>(tls_context(options.certificate).release());
  }
  bind();
}

void PagePort::Implementation::bind() {
  error_code error;
  const auto address = asio::ip::make_address_v4(options.address, error);
  if (error) {
    throw InputError(
        fmt::format("--listen {}: not an IPv4 address; e.g. 127.0.0.1", options.address));
  }
  if (!address.is_loopback() && !options.token.is_needed()) {
    throw InputError(fmt::format(
        "--listen {}: other machines could move a device on a finger; give --token FILE, a file "
        "with a secret that visitors must know",
        options.address));
  }
  if (!address.is_loopback() && !tls && !options.plain_http) {
    throw InputError(fmt::format(
        "--listen {}: others on the network could read the token and move the device; give "
        "--certificate FILE and --key FILE, or --plain-http where the network is trusted",
        options.address));
  }
  const tcp::endpoint endpoint(address, options.port);
  acceptor.open(endpoint.protocol());
  acceptor.set_option(asio::socket_base::reuse_address(true));
  acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error == asio::error::address_in_use) {
    throw InputError(fmt::format(
        "--port {0}: already in use; take another, or --port 0 for any free one", options.port));
  }
  if (error == asio::error::access_denied) {
    throw InputError(
        fmt::format("--port {}: not permitted; take one above 1023, or --port 0 for any free one",
                    options.port));
  }
  if (error) {
    throw InputError(
        fmt::format("--listen {}: no such address here; e.g. 127.0.0.1", options.address));
  }
  options.port = acceptor.local_endpoint().port();
}

PagePort::PagePort(ServerOptions options)
    : implementation_(std::make_unique<Implementation>(std::move(options))) {}
PagePort::~PagePort() = default;
PagePort::PagePort(PagePort&&) noexcept = default;

}  // namespace softfinger
