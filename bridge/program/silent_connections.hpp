// Connections that have not shown yet that they are of use: so many from one address, so many in
// all, and the oldest goes when one more comes. Whoever opens connections and says nothing so
// displaces himself first, and never somebody who speaks. Pure; one owner, one thread.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

namespace fieldcast::program {

class SilentConnections {
 public:
  using Ticket = std::uint64_t;
  using Cut = std::function<void()>;  // ends the connection; called once at most, after its removal

  SilentConnections(std::size_t most, std::size_t most_of_one)
      : most_(most), most_of_one_(most_of_one) {}

  // One more from this host, without its port. Cuts another one where there is no room.
  [[nodiscard]] Ticket add(const std::string& host, Cut cut);
  // It has shown its use, or is over. False: it was cut.
  bool remove(Ticket ticket);
  // Cuts the oldest one of the hosts that have the most. False: there is none.
  bool cut_one();

  [[nodiscard]] std::size_t size() const { return all_.size(); }

 private:
  struct Connection {
    std::string host;
    Cut cut;
  };
  void cut_oldest_of(const std::string& host);
  void cut(std::map<Ticket, Connection>::iterator which);

  const std::size_t most_, most_of_one_;
  std::map<Ticket, Connection> all_;       // the oldest first
  std::map<std::string, std::size_t> of_;  // how many, by host
  Ticket last_ = 0;
};

}  // namespace fieldcast::program
