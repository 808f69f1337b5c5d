#include "softfinger/viewer/server/page_hub.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "softfinger/viewer/own_address.hpp"
#include "softfinger/viewer/server/page_stream.hpp"

namespace softfinger {

namespace http = boost::beast::http;

namespace {

std::string_view value_of(const HttpRequest& request, http::field name) {
  return {request[name].data(), request[name].size()};
}

}  // namespace

PageHub::PageHub(const ServerOptions& options, bool encrypted)
    : token(options.token),
      address(options.address),
      scheme(encrypted ? "https" : "http"),
      port(options.port) {}

void PageHub::take_web_socket(PageStream&&, ConnectionCount&&, const HttpRequest&) {}

std::string PageHub::url() const {
  std::vector<std::string> urls;
  for (const std::string& at :
       address == "0.0.0.0" ? addresses_of_this_machine() : std::vector<std::string>{address}) {
    urls.push_back(fmt::format("{}://{}:{}{}", scheme, at, port,
                               token.is_needed() ? "/?token=" + token.text() : ""));
  }
  return fmt::format("{}", fmt::join(urls, " or "));
}

bool PageHub::is_foreign(const HttpRequest& request, std::string_view local) const {
  const auto hosts = request.count(http::field::host);
  const auto origins = request.count(http::field::origin);
  return hosts != 1 || !is_own_host(value_of(request, http::field::host), local, port, scheme) ||
         origins > 1 ||
         (origins == 1 &&
          !is_own_origin(value_of(request, http::field::origin), local, port, scheme));
}

bool PageHub::is_admitted(const HttpRequest& request) const {
  return !token.is_needed() || cookie.is_in(value_of(request, http::field::cookie), port);
}

bool PageHub::has_room_for(const boost::asio::ip::address& visitor) const {
  const auto same = std::ranges::count(unproven, visitor);
  return connections < kMaxConnections && unproven.size() < kMaxUnproven &&
         static_cast<std::size_t>(same) < kMaxUnprovenOfOne;
}

Unproven::Unproven(PageHub& hub, boost::asio::ip::address visitor)
    : hub_(hub), visitor_(std::move(visitor)) {
  hub_.unproven.push_back(visitor_);
}

Unproven::~Unproven() { hub_.unproven.erase(std::ranges::find(hub_.unproven, visitor_)); }

}  // namespace softfinger
