#include "environment_map.h"
#include "upload.h"

namespace lumel {

static const std::vector<Image> kBlack = {Image(1, 1, 3)};

EnvironmentMap::EnvironmentMap(const gpu::Device& device, const scene::Environment* environment)
    : exists_(environment != nullptr)
{
    gpu::UploadBatch batch(device);
    levels_ = uploadChain(batch, scene::HalfChain(exists_ ? environment->levels : kBlack), "environment");
    batch.finish();
    if (exists_)
        diffuse_ = environment->diffuse;
}

} // namespace lumel
