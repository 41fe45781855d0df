#pragma once

#include "core/status.h"
#include "eval/files/byte_io.h"
#include "gnss/base/gnss_time.h"

namespace alidade {

/// GnssTimeMsg: week and seconds of week of GPST.
void PutGnssTime(TimeNs gpst_ns, ByteWriter* out);
/// kInput: a week or second that no clock shows. A torn message is told by the reader's ok().
Result<TimeNs> TakeGnssTime(ByteReader* in);

/// kInput when more was read than there was.
Status CheckWhole(const ByteReader& in);

}  // namespace alidade
