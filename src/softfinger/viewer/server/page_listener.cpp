#include "softfinger/viewer/server/page_listener.hpp"

#include <boost/asio/post.hpp>

#include <chrono>
#include <exception>
#include <utility>

#include "softfinger/viewer/server/http_session.hpp"

namespace softfinger {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr int kSendBufferBytes = 64 * 1024;  // small: what waits in it is no longer the newest

}  // namespace

PageListener::PageListener(std::unique_ptr<PagePort::Implementation> port, PageHub& hub)
    : hub_(hub), port_(std::move(port)), retry_(port_->context) {}

PageListener::~PageListener() { end(); }

void PageListener::end() {
  context().stop();
  if (thread_.joinable()) thread_.join();
}

void PageListener::begin(std::function<void()> first) {
  thread_ = std::thread([this, first = std::move(first)] {
    asio::post(context(), [this, &first] {
      accept();
      if (first) first();
    });
    while (!context().stopped()) {
      try {
        context().run();
      } catch (const std::exception&) {
        // One connection's failure (out of memory, say) must not end the others.
      }
    }
  });
}

void PageListener::accept() {
  port_->acceptor.async_accept([this](error_code error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (error) {  // e.g. out of descriptors: wait for some to be free
      retry_.expires_after(std::chrono::milliseconds(100));
      retry_.async_wait([this](error_code) { accept(); });
      return;
    }
    accept();
    error_code ignored;
    const asio::ip::address visitor = socket.remote_endpoint(ignored).address();
    if (hub_.has_room_for(visitor)) {
      socket.set_option(tcp::no_delay(true), ignored);
      socket.set_option(asio::socket_base::send_buffer_size(kSendBufferBytes), ignored);
      PageStream stream(std::move(socket), port_->tls.get());
      std::make_shared<HttpSession>(std::move(stream), hub_, visitor)->open();
    }
  });
}

}  // namespace softfinger
