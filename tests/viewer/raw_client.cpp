#include "raw_client.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <stdexcept>

namespace softfinger {
namespace {

constexpr int kPatienceMs = 10'000;

unsigned byte_at(std::string_view text, std::size_t i) {
  return static_cast<unsigned char>(text[i]);
}

}  // namespace

int WebSocketFrame::close_code() const {
  return payload.size() < 2 ? 0 : static_cast<int>(byte_at(payload, 0) << 8 | byte_at(payload, 1));
}

RawClient::RawClient(std::uint16_t port, int receive_buffer)
    : socket_(socket(AF_INET, SOCK_STREAM, 0)), port_(port) {
  if (receive_buffer > 0) {
    setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
  }
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(socket_, std::bit_cast<sockaddr*>(&address), sizeof address) != 0) {
    throw std::runtime_error("cannot connect");
  }
}

RawClient::~RawClient() { close(socket_); }

void RawClient::send(std::string_view bytes) {
  while (!bytes.empty()) {
    const auto sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return;  // closed by the server; reading will tell
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
}

bool RawClient::fill() {
  pollfd readable{socket_, POLLIN, 0};
  if (poll(&readable, 1, kPatienceMs) <= 0) return false;
  std::array<char, 16384> chunk{};
  const auto received = recv(socket_, chunk.data(), chunk.size(), 0);
  if (received <= 0) return false;
  buffer_.append(chunk.data(), static_cast<std::size_t>(received));
  return true;
}

HttpAnswer RawClient::read_answer(bool has_body) {
  std::size_t end = std::string::npos;
  while ((end = buffer_.find("\r\n\r\n")) == std::string::npos) {
    if (!fill()) return {};
  }
  HttpAnswer answer;
  answer.header = buffer_.substr(0, end + 2);
  buffer_.erase(0, end + 4);
  answer.status = std::stoi(answer.header.substr(answer.header.find(' ') + 1));
  const auto length = answer.header.find("Content-Length: ");
  if (!has_body || length == std::string::npos) return answer;
  const auto size = std::stoul(answer.header.substr(length + 16));
  while (buffer_.size() < size) {
    if (!fill()) return {};
  }
  answer.body = buffer_.substr(0, size);
  buffer_.erase(0, size);
  return answer;
}

HttpAnswer RawClient::get(std::string_view target, std::string_view extra) {
  send("GET " + std::string(target) + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port_) +
       "\r\n" + std::string(extra) + "\r\n");
  return read_answer();
}

HttpAnswer RawClient::open_web_socket(std::string_view extra) {
  send("GET /ws HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port_) +
       "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
       "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
       std::string(extra) + "\r\n");
  return read_answer();
}

void RawClient::send_frame(int opcode, std::string_view payload) {
  std::string frame;
  frame += static_cast<char>(0x80 | opcode);
  if (payload.size() < 126) {
    frame += static_cast<char>(0x80 | payload.size());
  } else {
    frame += static_cast<char>(0x80 | 126);
    frame += static_cast<char>(payload.size() >> 8);
    frame += static_cast<char>(payload.size() & 0xff);
  }
  frame += std::string(4, '\0');  // a mask of zeros leaves the payload as it is
  frame += payload;
  send(frame);
}

std::optional<WebSocketFrame> RawClient::read_frame() {
  const auto need = [this](std::size_t size) {
    while (buffer_.size() < size) {
      if (!fill()) return false;
    }
    return true;
  };
  if (!need(2)) return {};
  std::size_t size = byte_at(buffer_, 1) & 0x7f;
  std::size_t start = 2;
  const std::size_t wide = size == 126 ? 2 : size == 127 ? 8 : 0;
  if (wide > 0) {
    if (!need(start + wide)) return {};
    size = 0;
    for (std::size_t i = 0; i < wide; ++i) size = size << 8 | byte_at(buffer_, start + i);
    start += wide;
  }
  if (!need(start + size)) return {};
  WebSocketFrame frame{static_cast<int>(byte_at(buffer_, 0) & 0x0f), buffer_.substr(start, size)};
  buffer_.erase(0, start + size);
  return frame;
}

std::optional<WebSocketFrame> RawClient::read_frame(int opcode) {
  auto frame = read_frame();
  while (frame && frame->opcode != opcode) frame = read_frame();
  return frame;
}

bool RawClient::is_closed() {
  std::array<char, 4096> chunk{};
  for (;;) {
    pollfd readable{socket_, POLLIN, 0};
    if (poll(&readable, 1, kPatienceMs) <= 0) return false;
    if (recv(socket_, chunk.data(), chunk.size(), 0) <= 0) return true;
  }
}

}  // namespace softfinger
