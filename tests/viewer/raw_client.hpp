#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace softfinger {

struct HttpAnswer {
  int status = 0;
  std::string header;  ///< status line and fields
  std::string body;
};

struct WebSocketFrame {
  int opcode = 0;  ///< 1 text, 2 binary, 8 close, 9 ping
  std::string payload;
  /// Of a close frame.
  [[nodiscard]] int close_code() const;
};

/// A TCP client that sends exactly the bytes it is told, also wrong ones.
class RawClient {
 public:
  /// `receive_buffer` bytes at most wait for being read; 0: as the system likes.
  explicit RawClient(std::uint16_t port, int receive_buffer = 0);
  ~RawClient();
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  void send(std::string_view bytes);
  /// Reads one response with a Content-Length; status 0 where the server closes or stays silent.
  HttpAnswer read_answer(bool has_body = true);
  /// "GET target" with the usual fields, then `extra` ("Name: value\r\n").
  HttpAnswer get(std::string_view target, std::string_view extra = "");

  /// Handshake on /ws.
  HttpAnswer open_web_socket(std::string_view extra = "");
  void send_frame(int opcode, std::string_view payload);
  /// The next frame, empty where the server closes or stays silent for 10 s.
  std::optional<WebSocketFrame> read_frame();
  /// The next frame of an opcode, others left out.
  std::optional<WebSocketFrame> read_frame(int opcode);
  /// Whether the server closes the connection within 10 s.
  bool is_closed();

 private:
  bool fill();  ///< reads more into buffer_

  int socket_ = -1;
  std::uint16_t port_;
  std::string buffer_;
};

}  // namespace softfinger
