// Connections whose peers have not authenticated yet. Their number is bounded, for each address and
// in total; a further one cuts the oldest. So an address that opens many connections and sends
// nothing loses its own first, and authenticated connections are never cut. Pure; one owner, one
// thread.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

namespace fieldcast::program {

class SilentConnections {
 public:
  using Id = std::uint64_t;
  using Cut = std::function<void()>;  // ends the connection; called at most once, after its removal

  SilentConnections(std::size_t most, std::size_t most_of_one)
      : most_(most), most_of_one_(most_of_one) {}

  // Adds a connection of this host (without port). Cuts an older one if a limit is reached.
  [[nodiscard]] Id add(const std::string& host, Cut cut);
  // Removes a connection that has authenticated or ended. Returns false if it was cut.
  bool remove(Id id);
  // Cuts the oldest connection of the hosts with the most. Returns false if there is none.
  bool cut_one();

  [[nodiscard]] std::size_t size() const { return all_.size(); }

 private:
  struct Connection {
    std::string host;
    Cut cut;
  };
  void cut_oldest_of(const std::string& host);
  void cut(std::map<Id, Connection>::iterator which);

  const std::size_t most_, most_of_one_;
  std::map<Id, Connection> all_;           // the oldest first
  std::map<std::string, std::size_t> of_;  // number of connections by host
  Id last_ = 0;
};

}  // namespace fieldcast::program
