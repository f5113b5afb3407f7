// A stream without a socket; the test is the client. Runs on the thread of the io_context.
#pragma once

#include <boost/asio/error.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <cstring>
#include <memory>
#include <string>
#include <utility>

#include "bridge/net/byte_stream.hpp"

namespace fieldcast::web {

struct MemoryLink {
  std::string to_station;    // not yet read
  std::string to_client;     // all bytes sent
  std::size_t takes = ~0ul;  // bytes that the client still accepts
  bool client_gone = false, station_ended = false, station_closed = false;
  std::size_t most_of_a_read = ~0ul;
  std::function<void()> wake = [] {};
};

class MemoryStream final : public ByteStream {
 public:
  MemoryStream(boost::asio::io_context& io, std::shared_ptr<MemoryLink> link)
      : io_(io), state_(std::make_shared<State>()) {
    state_->link = std::move(link);
    state_->link->wake = [weak = std::weak_ptr(state_), this] {
      if (weak.lock()) serve();
    };
  }
  ~MemoryStream() override { close(); }

  void read_some(boost::asio::mutable_buffer into, Done done) override {
    state_->into = into;
    state_->read = std::move(done);
    serve();
  }
  void write_some(boost::asio::const_buffer from, Done done) override {
    state_->from = from;
    state_->write = std::move(done);
    serve();
  }
  std::size_t queued() const override { return 0; }
  void end_sending() override { state_->link->station_ended = true; }
  void close() override {
    state_->link->station_closed = true;
    finish(state_->read, boost::asio::error::operation_aborted, 0);
    finish(state_->write, boost::asio::error::operation_aborted, 0);
  }

 private:
  struct State {
    std::shared_ptr<MemoryLink> link;
    boost::asio::mutable_buffer into;
    boost::asio::const_buffer from;
    Done read, write;
  };

  void serve() {
    MemoryLink& link = *state_->link;
    if (state_->read && !link.to_station.empty()) {
      const std::size_t count =
          std::min({state_->into.size(), link.to_station.size(), link.most_of_a_read});
      std::memcpy(state_->into.data(), link.to_station.data(), count);
      link.to_station.erase(0, count);
      finish(state_->read, {}, count);
    } else if (state_->read && link.client_gone) {
      finish(state_->read, boost::asio::error::eof, 0);
    }
    if (state_->write && link.client_gone) {
      finish(state_->write, boost::asio::error::broken_pipe, 0);
    } else if (state_->write && link.takes > 0) {
      const std::size_t count = std::min(state_->from.size(), link.takes);
      link.to_client.append(static_cast<const char*>(state_->from.data()), count);
      if (link.takes != ~0ul) link.takes -= count;
      finish(state_->write, {}, count);
    }
  }
  void finish(Done& done, boost::system::error_code fault, std::size_t count) {
    if (!done) return;
    boost::asio::post(io_, [done = std::exchange(done, {}), fault, count] { done(fault, count); });
  }

  boost::asio::io_context& io_;
  std::shared_ptr<State> state_;
};

}  // namespace fieldcast::web
