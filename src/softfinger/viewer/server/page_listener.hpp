#pragma once

#include <utility>  // before Boost: its 1.74 headers use std::exchange without it

#include <boost/asio/steady_timer.hpp>

#include <functional>
#include <memory>
#include <thread>

#include "softfinger/viewer/server/bound_port.hpp"
#include "softfinger/viewer/server/page_hub.hpp"

namespace softfinger {

/// Answers who comes to a port, on a thread of its own, until destroyed.
class PageListener {
 public:
  /// `hub` must outlive the listener.
  PageListener(std::unique_ptr<PagePort::Implementation> port, PageHub& hub);
  ~PageListener();
  PageListener(const PageListener&) = delete;
  PageListener& operator=(const PageListener&) = delete;

  /// Begins, with this first on the thread.
  void begin(std::function<void()> first = {});
  /// Ends the thread.
  void end();
  [[nodiscard]] boost::asio::io_context& context() { return port_->context; }

 private:
  void accept();

  // Connections point at the hub and are destroyed with the port's context.
  PageHub& hub_;
  std::unique_ptr<PagePort::Implementation> port_;
  boost::asio::steady_timer retry_;
  std::thread thread_;
};

}  // namespace softfinger
