/* A plant system in C on Cyclone DDS: writes an integer to a channel, and prints the one result of
 * the command.
 *
 * usage: cyclone-write DOMAIN BUS DEVICE CHANNEL INTEGER [verify]
 *   result REQUEST_ID STATE CAUSE REASON
 * Exit code 0 only if the device has executed it, 1 for every other result, 3 without a bridge or a
 * result. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "station.h"

enum { kWaitSeconds = 10 };

/* Returns the exit code. Results of all requesters arrive: this one is found by its keys. */
static int await_result(dds_entity_t reader, const fieldcast_Command* command, dds_time_t until) {
  for (; dds_time() < until && !stopped(); dds_sleepfor(DDS_MSECS(2))) {
    void* samples[1] = {NULL};
    dds_sample_info_t info;
    while (dds_take(reader, samples, &info, 1, 1) == 1) {
      const fieldcast_CommandResult* r = samples[0];
      const bool ours = info.valid_data && r->request_id == command->request_id &&
                        strcmp(r->requester, command->requester) == 0;
      const fieldcast_CommandState state = r->state;
      if (ours)
        printf("result\t%" PRIu64 "\t%s\t%s\t%s\n", r->request_id, state_name(state), r->cause,
               r->reason);
      dds_return_loan(reader, samples, 1);
      if (ours) return state == fieldcast_DONE || state == fieldcast_VERIFIED ? 0 : 1;
    }
  }
  fprintf(stderr, "no result within %d s\n", kWaitSeconds);
  return 3;
}

int main(int argc, char** argv) {
  if (argc < 6) {
    fprintf(stderr, "usage: cyclone-write DOMAIN BUS DEVICE CHANNEL INTEGER [verify]\n");
    return 2;
  }
  const dds_entity_t participant = participant_in(argv[1]);
  dds_qos_t* qos = request_qos();
  const dds_entity_t results =
      reader_of(participant, &fieldcast_CommandResult_desc, "fieldcast/CommandResult", qos);
  dds_qset_lifespan(qos, DDS_SECS(5)); /* the bridge never starts it later than this */
  dds_qset_writer_data_lifecycle(qos, false);
  const dds_entity_t commands =
      writer_of(participant, &fieldcast_Command_desc, "fieldcast/Command", qos);
  dds_delete_qos(qos);

  const dds_time_t until = dds_time() + DDS_SECS(kWaitSeconds);
  if (!matched(commands, results, until)) {
    fprintf(stderr, "no bridge within %d s\n", kWaitSeconds);
    return 3;
  }
  fieldcast_Value value = {._d = fieldcast_VALUE_INT64, ._u.int64_value = atoll(argv[5])};
  static fieldcast_Command command; /* zeroed */
  command.request_id = 1;
  set_write(&command, argv + 2, &value);
  command.verify = argc > 6 && strcmp(argv[6], "verify") == 0;
  need(dds_write(commands, &command), "write");
  const int code = await_result(results, &command, until);
  dds_unregister_instance(commands,
                          &command); /* its key is never used again: both ends may release it */
  dds_delete(participant);
  return code;
}
