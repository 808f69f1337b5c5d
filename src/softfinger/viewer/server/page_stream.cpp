#include "softfinger/viewer/server/page_stream.hpp"

#include <boost/asio/ssl/stream_base.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>

#include <variant>

namespace softfinger {

struct PageStream::Connection {
  using Plain = boost::beast::tcp_stream;
  using Secure = boost::beast::ssl_stream<boost::beast::tcp_stream>;

  Connection(boost::asio::ip::tcp::socket&& socket, boost::asio::ssl::context* tls)
      : stream(tls == nullptr
                   ? std::variant<Plain, Secure>(std::in_place_type<Plain>, std::move(socket))
                   : std::variant<Plain, Secure>(std::in_place_type<Secure>, std::move(socket),
                                                 *tls)) {}

  std::variant<Plain, Secure> stream;
};

PageStream::PageStream(boost::asio::ip::tcp::socket&& socket, boost::asio::ssl::context* tls)
    : connection_(std::make_unique<Connection>(std::move(socket), tls)) {}
PageStream::PageStream(PageStream&&) noexcept = default;
PageStream::~PageStream() = default;

boost::beast::tcp_stream& PageStream::next_layer() {
  auto* secure = std::get_if<Connection::Secure>(&connection_->stream);
  return secure != nullptr ? secure->next_layer()
                           : std::get<Connection::Plain>(connection_->stream);
}

void PageStream::open(std::function<void(boost::system::error_code)> done) {
  if (auto* secure = std::get_if<Connection::Secure>(&connection_->stream)) {
    secure->async_handshake(boost::asio::ssl::stream_base::server, std::move(done));
  } else {
    done(boost::system::error_code());
  }
}

void PageStream::read_some(const Some<boost::asio::mutable_buffer>& buffers, Done done) {
  std::visit([&](auto& stream) { stream.async_read_some(buffers, std::move(done)); },
             connection_->stream);
}

void PageStream::write_some(const Some<boost::asio::const_buffer>& buffers, Done done) {
  std::visit([&](auto& stream) { stream.async_write_some(buffers, std::move(done)); },
             connection_->stream);
}

}  // namespace softfinger
