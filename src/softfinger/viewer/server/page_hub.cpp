#include "softfinger/viewer/server/page_hub.hpp"

#include "softfinger/viewer/own_address.hpp"

namespace softfinger {

namespace http = boost::beast::http;

namespace {

std::string_view value_of(const HttpRequest& request, http::field name) {
  return {request[name].data(), request[name].size()};
}

}  // namespace

bool PageHub::is_foreign(const HttpRequest& request, std::string_view local) const {
  const auto hosts = request.count(http::field::host);
  const auto origins = request.count(http::field::origin);
  return hosts != 1 || !is_own_host(value_of(request, http::field::host), local, port, scheme) ||
         origins > 1 ||
         (origins == 1 &&
          !is_own_origin(value_of(request, http::field::origin), local, port, scheme));
}

bool PageHub::is_admitted(const HttpRequest& request) const {
  return !token.is_needed() || token.is_in_cookies(value_of(request, http::field::cookie));
}

}  // namespace softfinger
