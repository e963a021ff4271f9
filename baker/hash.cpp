#include "bake.h"
#include "core/file.h"

namespace lumel::baker {

std::string sourceHash(const Maps& maps, const Options& options)
{
    ContentHash hash;
    hash.add(std::string(kVersion));
    for (const Image* image : {&maps.height, &maps.normal, &maps.power, &maps.roughness, &maps.anisotropy,
                               &maps.tangentRotation, &maps.specular, &maps.diffuse}) {
        hash.addValue(image->width).addValue(image->height).addValue(image->channels);
        hash.add(image->pixels.data(), image->pixels.size() * sizeof(float));
    }
    hash.addValue(maps.heightScale).addValue(maps.normalGreenUp).addValue(maps.signedNormals);
    hash.addValue(maps.normalScale).addValue(maps.wrap);
    hash.addValue(maps.powerConstant).addValue(maps.anisotropicPower);
    hash.addValue(maps.specularConstant).addValue(maps.diffuseConstant);
    // The number of threads changes nothing in the result.
    hash.addValue(options.method).addValue(options.model).addValue(options.reduce);
    hash.addValue(options.reconstruction);
    return hash.hex();
}

} // namespace lumel::baker
