#pragma once

#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <optional>
#include <vector>

#include "bridge/store/users/user_table.hpp"
#include "tools/station/api/administration.hpp"
#include "tools/station/live/live_domain.hpp"
#include "tools/station/settings/configuration.hpp"
#include "tools/station/stream/stream_reader.hpp"
#include "tools/station/web/site.hpp"
#include "tools/station/web/station_server.hpp"

namespace fieldcast::web {

[[nodiscard]] std::vector<Metric> metrics_of(const LiveDomain& domain, const StreamReader* stream,
                                             const StationServer& server);

// Empty if clients must log in. `users`: number of users; empty if unknown.
[[nodiscard]] std::optional<Role> local_role_of(const StationSpec& spec,
                                                std::optional<std::size_t> users);

// Reads the users of the store periodically. Ends logins of removed or changed users, and updates
// the role of clients without a login. Runs on the io thread.
class UserWatch {
 public:
  static constexpr Duration kPeriod = std::chrono::seconds{5};
  using Users = std::optional<std::vector<User>>;  // empty: the store cannot be read now
  // Reads the users without blocking; `done` is called on the io thread.
  using Ask = std::function<void(std::function<void(Users)> done)>;

  // The site must outlive this object.
  UserWatch(boost::asio::io_context& io, const StationSpec& spec, Site& site, Ask ask);
  ~UserWatch();
  UserWatch(const UserWatch&) = delete;
  UserWatch& operator=(const UserWatch&) = delete;

  void look();

 private:
  void on_users(const Users& users);

  const StationSpec spec_;
  Site& site_;
  const Ask ask_;
  boost::asio::steady_timer timer_;
  std::optional<std::size_t> users_;  // number of users at the last successful read
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

}  // namespace fieldcast::web
