#pragma once

#include "core/status.h"
#include "eval/files/byte_io.h"
#include "gnss/base/gnss_time.h"

namespace alidade {

/// GnssTimeMsg: week and seconds of week of GPST.
void PutGnssTime(TimeNs gpst_ns, ByteWriter* out);
/// kInput: an invalid week or second. A torn message makes the reader's ok() false.
Result<TimeNs> TakeGnssTime(ByteReader* in);

/// kInput when more was read than there was.
Status CheckWhole(const ByteReader& in);

}  // namespace alidade
