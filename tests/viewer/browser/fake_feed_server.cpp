// Serves the live page with a synthetic feed until it is ended: to work on the page, and to test
// it, without an engine. fake_feed_server [PORT]; prints the address.
#include <cstdio>
#include <cstdlib>
#include <exception>

#include <csignal>

#include "../synthetic_feed.hpp"
#include "softfinger/viewer/server.hpp"

int main(int argc, char** argv) {
  try {
    sigset_t ends;
    sigemptyset(&ends);
    sigaddset(&ends, SIGINT);
    sigaddset(&ends, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &ends, nullptr);
    softfinger::SyntheticFeed feed;
    softfinger::ServerOptions options;
    options.port = static_cast<std::uint16_t>(argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 0);
    const softfinger::Server server(feed, options);
    std::printf("%s\n", server.url().c_str());
    std::fflush(stdout);
    int signal = 0;
    sigwait(&ends, &signal);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fake_feed_server: %s\n", error.what());
    return 2;
  }
}
