#pragma once

#include <utility>  // before Boost: its 1.74 headers use std::exchange without it

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>

#include <memory>

#include "softfinger/viewer/page_port.hpp"

namespace softfinger {

struct PagePort::Implementation {
  ServerOptions options;                           ///< `port`: the one bound
  std::unique_ptr<boost::asio::ssl::context> tls;  ///< null: plain
  boost::asio::io_context context{1};
  boost::asio::ip::tcp::acceptor acceptor{context};

  explicit Implementation(ServerOptions of);
  void bind();
};

}  // namespace softfinger
