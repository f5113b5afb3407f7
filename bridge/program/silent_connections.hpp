// Connections whose peers have not proven themselves yet. Their number is bounded, for each address
// and in all; one more cuts the oldest. So an address that opens many connections and sends nothing
// loses its own first, and connections that have proven themselves are never cut. Pure; one owner,
// one thread.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

namespace fieldcast::program {

class SilentConnections {
 public:
  using Id = std::uint64_t;
  using Cut = std::function<void()>;  // ends the connection; called once at most, after its removal

  SilentConnections(std::size_t most, std::size_t most_of_one)
      : most_(most), most_of_one_(most_of_one) {}

  // One more from this host, without its port. Cuts another one where a limit is reached.
  [[nodiscard]] Id add(const std::string& host, Cut cut);
  // It has proven itself, or is over. False: it was cut.
  bool remove(Id id);
  // Cuts the oldest one of the hosts that have the most. False: there is none.
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
  std::map<std::string, std::size_t> of_;  // how many, by host
  Id last_ = 0;
};

}  // namespace fieldcast::program
