// The level-0 lobes: what the maps say at each texel, decoded a run of texels at a time. Nothing is
// stored per texel, so an 8192 x 8192 height map costs only itself.
#pragma once
#include "bake.h"

namespace lumel::baker {

// A run of lobes as arrays, one entry per texel. The covariance S = P^-1 is in the frame of the normal.
struct Lobes {
    std::vector<float> nx, ny, nz;    // unit normal
    std::vector<float> sxx, sxy, syy; // roughness covariance
    std::vector<float> ks[3], kd[3];
    size_t size() const { return nx.size(); }
    glm::vec3 covariance(size_t m) const { return {sxx[m], sxy[m], syy[m]}; }
    void resize(size_t count);
    // Copies `other` to the entries from `at` on; grows as needed.
    void append(const Lobes& other, size_t at);
};

// The smaller eigenvalue of a lobe's precision: 1 / variance along its long side.
float lowestPower(const Lobes& lobes, size_t index);

class Source {
public:
    // Keeps a reference to `maps`. Throws Error for unusable maps, naming map and remedy.
    explicit Source(const Maps& maps);

    int width() const { return width_; }
    int height() const { return height_; }
    bool isotropic() const { return isotropic_; }               // every S is a multiple of the identity
    bool colouredSpecular() const { return colouredSpecular_; } // Ks varies in more than brightness
    bool constantPower() const { return constantPower_; }       // one S for all texels, up to its direction
    // Largest power of any texel: bounds how narrow any lobe can be.
    float maxPower() const { return maxPower_; }

    // Texels [x0, x1) of row y into `out` from index `at` on; `out` is large enough.
    void read(int y, int x0, int x1, Lobes& out, size_t at) const;

private:
    struct Sampler;
    void readNormals(int y, int x0, int x1, Lobes& out, size_t at) const;
    void readPowers(int y, int x0, int x1, Lobes& out, size_t at) const;
    void readColours(const Image& image, glm::vec3 constant, int y, int x0, int x1,
                     std::vector<float>* channels, size_t at) const;
    glm::vec3 nativeNormal(int x, int y) const;

    const Maps& maps_;
    int width_ = 0;
    int height_ = 0;
    bool isotropic_ = true;
    bool colouredSpecular_ = false;
    bool constantPower_ = false;
    float maxPower_ = 1.0f;
};

} // namespace lumel::baker
