/* A plant system in C on Cyclone DDS whose writer wrongly keeps its commands for late joiners: a
 * reader that joins later receives them again.
 *
 * usage: cyclone-replay DOMAIN BUS DEVICE CHANNEL COUNT
 *   result REQUEST_ID STATE CAUSE REASON
 * Writes the integers 1 to COUNT, each a command of 60 s, and prints every result until SIGTERM. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "station.h"

enum { kWaitSeconds = 20 };

static void print_results(dds_entity_t reader, const char* requester) {
  void* samples[1] = {NULL};
  dds_sample_info_t info;
  while (dds_take(reader, samples, &info, 1, 1) == 1) {
    const fieldcast_CommandResult* r = samples[0];
    if (info.valid_data && strcmp(r->requester, requester) == 0)
      printf("result\t%" PRIu64 "\t%s\t%s\t%s\n", r->request_id, state_name(r->state), r->cause,
             r->reason);
    dds_return_loan(reader, samples, 1);
  }
  fflush(stdout);
}

int main(int argc, char** argv) {
  if (argc < 6) {
    fprintf(stderr, "usage: cyclone-replay DOMAIN BUS DEVICE CHANNEL COUNT\n");
    return 2;
  }
  const uint64_t count = strtoull(argv[5], NULL, 10);
  const dds_entity_t participant = participant_in(argv[1]);
  dds_qos_t* qos = request_qos();
  const dds_entity_t results =
      reader_of(participant, &fieldcast_CommandResult_desc, "fieldcast/CommandResult", qos);
  dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
  dds_qset_durability_service(qos, 0, DDS_HISTORY_KEEP_ALL, 0, DDS_LENGTH_UNLIMITED,
                              DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  dds_qset_lifespan(qos, DDS_SECS(60));
  const dds_entity_t commands =
      writer_of(participant, &fieldcast_Command_desc, "fieldcast/Command", qos);
  dds_delete_qos(qos);
  if (!matched(commands, results, dds_time() + DDS_SECS(kWaitSeconds))) {
    fprintf(stderr, "no bridge within %d s\n", kWaitSeconds);
    return 3;
  }
  fieldcast_Value value = {._d = fieldcast_VALUE_INT64};
  static fieldcast_Command command; /* zeroed */
  set_write(&command, argv + 2, &value);
  for (command.request_id = 1; command.request_id <= count; ++command.request_id) {
    value._u.int64_value = (int64_t)command.request_id;
    need(dds_write(commands, &command), "write");
  }
  for (; !stopped(); dds_sleepfor(DDS_MSECS(5))) print_results(results, command.requester);
  dds_delete(participant);
  return 0;
}
