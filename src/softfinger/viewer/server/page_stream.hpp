#pragma once

#include <utility>  // before Boost: its 1.74 headers use std::exchange without it

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket/teardown.hpp>

#include <array>
#include <functional>
#include <memory>
#include <type_traits>

namespace softfinger {

/// A connection, plain or over TLS: what Beast asks of an asynchronous stream.
///
/// Every composed operation of Beast would be compiled for both, at ten times the cost of all else
/// here: handlers and buffers lose their types before they reach the connection.
class PageStream {
 public:
  using executor_type = boost::beast::tcp_stream::executor_type;

  /// `tls`: null for a plain connection.
  PageStream(boost::asio::ip::tcp::socket&& socket, boost::asio::ssl::context* tls);
  PageStream(PageStream&&) noexcept;
  ~PageStream();

  boost::beast::tcp_stream& next_layer();
  executor_type get_executor() { return next_layer().get_executor(); }

  /// Calls done(error) once bytes may be exchanged.
  void open(std::function<void(boost::system::error_code)> done);

  template <typename Buffers, typename Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    read_some(some_of<boost::asio::mutable_buffer>(buffers),
              Done::of(std::forward<Handler>(handler)));
  }
  template <typename Buffers, typename Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    write_some(some_of<boost::asio::const_buffer>(buffers),
               Done::of(std::forward<Handler>(handler)));
  }

 private:
  /// A handler that can be moved and called once.
  class Done {
   public:
    template <typename Handler>
    static Done of(Handler&& handler) {
      Done done;
      done.call_ = std::make_unique<CallOf<std::decay_t<Handler>>>(
          std::decay_t<Handler>(std::forward<Handler>(handler)));
      return done;
    }
    void operator()(boost::system::error_code error, std::size_t bytes) {
      const std::unique_ptr<Call> call = std::move(call_);
      call->call(error, bytes);
    }

   private:
    struct Call {
      virtual ~Call() = default;
      virtual void call(boost::system::error_code error, std::size_t bytes) = 0;
    };
    template <typename Handler>
    struct CallOf : Call {
      explicit CallOf(Handler&& of) : handler(std::move(of)) {}
      void call(boost::system::error_code error, std::size_t bytes) override {
        // What the handler holds may end with it: it leaves this first.
        Handler moved = std::move(handler);
        moved(error, bytes);
      }
      Handler handler;
    };
    std::unique_ptr<Call> call_;
  };

  /// The first buffers that are not empty: to exchange some of the bytes is all that is asked.
  template <typename Buffer>
  using Some = std::array<Buffer, 8>;
  template <typename Buffer, typename Buffers>
  static Some<Buffer> some_of(const Buffers& buffers) {
    Some<Buffer> some;
    std::size_t count = 0;
    const auto end = boost::asio::buffer_sequence_end(buffers);
    for (auto at = boost::asio::buffer_sequence_begin(buffers); at != end && count < some.size();
         ++at) {
      const Buffer buffer(*at);
      if (buffer.size() > 0) some[count++] = buffer;
    }
    return some;
  }

  void read_some(const Some<boost::asio::mutable_buffer>& buffers, Done done);
  void write_some(const Some<boost::asio::const_buffer>& buffers, Done done);

  struct Connection;
  std::unique_ptr<Connection> connection_;
};

/// Ends the connection after the closing messages of a WebSocket, which say all that TLS would.
template <typename Handler>
void async_teardown(boost::beast::role_type role, PageStream& stream, Handler&& handler) {
  boost::beast::websocket::async_teardown(role, stream.next_layer().socket(),
                                          std::forward<Handler>(handler));
}

}  // namespace softfinger
