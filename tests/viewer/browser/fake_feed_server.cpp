// Serves the live page with a synthetic feed until it is ended: to work on the page, and to test
// it, without an engine. fake_feed_server [PORT]; prints the address. Its standard input may say
// "say LINE" (what people are told), "loading SCENE", "loading", "freeze" and "go on".
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>
#include <thread>

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
    std::thread([&feed] {
      for (std::string line; std::getline(std::cin, line);) {
        if (line.rfind("say ", 0) == 0) feed.say(line.substr(4));
        if (line == "freeze" || line == "go on") feed.set_frozen(line == "freeze");
        if (line.rfind("loading", 0) == 0)
          feed.set_loading(line.substr(std::min<std::size_t>(8, line.size())));
      }
    }).detach();
    int signal = 0;
    sigwait(&ends, &signal);
    std::_Exit(0);  // without waiting for a line
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fake_feed_server: %s\n", error.what());
    return 2;
  }
}
